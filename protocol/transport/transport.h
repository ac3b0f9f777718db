// How messages travel: the one interface between a server or client and the network below it.
//
// ENet implements it for real networks, a seeded link on virtual time for tests, a WebSocket for the page. Both ends
// use the same interface; a client's transport has exactly one connection. Nothing here reads a clock: `now` is in
// seconds since any fixed moment and never goes backwards.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/transport/net_address.h"

namespace wobble::transport {

struct Admission;  // admission.h

// Unique within a transport for its whole life, never reused, never 0.
using ConnectionId = std::uint32_t;

// control: reliable and ordered. input, snapshot: unreliable, unsequenced, at most protocol::kMaxPacketBytes.
enum class Channel : std::uint8_t { kControl = 0, kInput = 1, kSnapshot = 2 };
inline constexpr std::size_t kChannelCount = 3;

// Event::reason where what a client has shown to be let in does not hold. The answer is the same while an address is
// not listened to because it was wrong too often. At most 123 bytes: a WebSocket is closed with it.
inline constexpr std::string_view kBadCredentialReason =
    "the password, invite or token is missing or not valid, or too many were tried from your address: wait 5 s";

struct Event {
  // kOffence: the far end sends what no honest one does, or takes nothing that is sent to it; it is to be disconnected.
  enum class Kind { kConnected, kDisconnected, kMessage, kOffence };
  Kind kind;
  ConnectionId connection;
  Channel channel = Channel::kControl;       // of a message
  std::span<const std::uint8_t> bytes = {};  // of a message; valid only inside the sink
  std::string_view reason = {};              // of kDisconnected: a line for people where it is known; a literal
  // Of kConnected at a server, valid only inside the sink; null: nothing is known of the client.
  const Admission* admission = nullptr;
  bool isFinal = false;  // of kDisconnected: the far end will not let this client in again either
};

enum class SendResult { kQueued, kUnknownConnection, kTooLarge, kFailed };

// Why a server lets clients not in before they can say hello, in more detail than it tells them.
enum class Turnaway : std::uint8_t {
  kFull,
  kTooManyFromAddress,
  kNothingShown,  // where something is asked for, or nothing that can be read
  kPassword,      // this one and the next three: what was shown does not hold
  kToken,         // or the ticket
  kInvite,
  kOwnerKey,
  kGateway,         // a gateway's introduction by another key, or by a clock that is wrong
  kTooManyGuesses,  // of an address that was wrong too often; what it showed now was not looked at
  kBanned,
};
inline constexpr std::size_t kTurnawayCount = 10;

struct Turnaways {
  std::uint64_t count = 0;
  NetAddress last = {};  // whose was the last one
};

// What a server answers to strangers who ask what is played (protocol/server_query.h).
enum class QueryAnswer : std::uint8_t { kChallenge, kInfo, kPlayers, kRules };
inline constexpr std::size_t kQueryAnswerCount = 4;
using QueryCounts = std::array<std::uint64_t, kQueryAnswerCount>;  // by QueryAnswer

// Counts since the transport was made.
struct Statistics {
  std::uint64_t datagramsRejected = 0;  // truncated, of another protocol or forged; dropped without any effect
  std::uint64_t messagesRejected = 0;   // whole, but on an unknown channel or larger than allowed
  std::uint64_t bytesIn = 0;            // datagram payloads, the transport's own headers included
  std::uint64_t bytesOut = 0;
  std::array<Turnaways, kTurnawayCount> turnaways = {};  // of a server, by Turnaway
  QueryCounts queries = {};                              // of a server
};

class Transport {
 public:
  using Sink = std::function<void(const Event&)>;

  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  // Takes in what has arrived by `now`, repeats what is due again, and passes every event to `sink` in order. The sink
  // may call Send and Disconnect.
  virtual void Poll(double now, const Sink& sink) = 0;

  // Queues one message; it leaves with Flush at the latest.
  [[nodiscard]] virtual SendResult Send(ConnectionId connection, Channel channel,
                                        std::span<const std::uint8_t> message) = 0;

  // Ends a connection once everything sent reliably before has been delivered, or the peer is gone. A kDisconnected
  // event follows, also when the far end closes by itself. Unknown ids are ignored.
  virtual void Disconnect(ConnectionId connection) = 0;

  virtual void Flush() = 0;

  [[nodiscard]] virtual Statistics ReadStatistics() const = 0;

  // Smoothed time from sending a reliable message to its acknowledgement, seconds; a guess until it has been measured;
  // 0 where it cannot be.
  [[nodiscard]] virtual double ReadRoundTrip(ConnectionId) const { return 0; }

  // What a client may come back with as a vestibule::Credential::Kind::kToken; empty: the server gave nothing.
  [[nodiscard]] virtual std::vector<std::uint8_t> ReadTicket() const { return {}; }
};

// The longest wait for an acknowledgement before a reliable message is sent again, seconds. ENet doubles the wait
// without a limit, which leaves so few tries on a link with heavy loss that connections time out: at 1 s of delay and
// 25 % loss each way the fifth try comes a minute after the first. One try in one and a half round trips never comes
// before the answer could be there, and its traffic is negligible on a link of any rate.
[[nodiscard]] constexpr double FindLongestRetry(double roundTrip) {
  return roundTrip > 0.25 / 1.5 ? 1.5 * roundTrip : 0.25;
}

}  // namespace wobble::transport
