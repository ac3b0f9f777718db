// How messages travel: the one interface between a server or client and the network beneath it.
//
// ENet is behind it in play, a seeded link on virtual time in tests. Both ends use the same interface; a client's
// transport has exactly one connection. Nothing here reads a clock: `now` is in seconds since any fixed moment and
// never goes backwards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace wobble::transport {

// Unique within one transport for its whole life, never reused, never 0.
using ConnectionId = std::uint32_t;

// control: reliable and ordered. input, snapshot: unreliable, unsequenced, at most protocol::kMaxPacketBytes.
enum class Channel : std::uint8_t { kControl = 0, kInput = 1, kSnapshot = 2 };
inline constexpr std::size_t kChannelCount = 3;

struct Event {
  enum class Kind { kConnected, kDisconnected, kMessage };
  Kind kind;
  ConnectionId connection;
  Channel channel = Channel::kControl;  // of a message
  std::span<const std::uint8_t> bytes;  // of a message; valid only inside the sink
};

enum class SendResult { kQueued, kUnknownConnection, kTooLarge, kFailed };

// Counts since the transport was made.
struct Statistics {
  std::uint64_t datagramsRejected = 0;  // arrived, but were not whole, not ours or forged; nobody noticed
  std::uint64_t messagesRejected = 0;   // whole, but on a channel that does not exist or over the size allowed
  std::uint64_t bytesIn = 0;            // datagram payloads, the transport's own headers included
  std::uint64_t bytesOut = 0;
};

class Transport {
 public:
  using Sink = std::function<void(const Event&)>;

  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  // Takes in all that has arrived by `now`, sends what is due again, and hands every event to `sink` in order.
  // The sink may call Send and Disconnect.
  virtual void Poll(double now, const Sink& sink) = 0;

  // Queues one message; it leaves with Flush at the latest.
  [[nodiscard]] virtual SendResult Send(ConnectionId connection, Channel channel,
                                        std::span<const std::uint8_t> message) = 0;

  // Ends a connection once what was sent reliably before has been delivered (or the peer is gone). A kDisconnected
  // event follows, also for an id whose far end closes by itself. Unknown ids are ignored.
  virtual void Disconnect(ConnectionId connection) = 0;

  virtual void Flush() = 0;

  [[nodiscard]] virtual Statistics ReadStatistics() const = 0;

  // Smoothed time from sending something reliable to its acknowledgement, seconds, or a guess until that is known. 0
  // where there is none to be known.
  [[nodiscard]] virtual double ReadRoundTrip(ConnectionId) const { return 0; }
};

// The longest that a transport waits for an acknowledgement before it sends something reliable again, seconds. Doubling
// without an end, as ENet has it, leaves so few tries on a link that loses much that a connection dies of the wait: at
// 1 s of delay and 25 % loss each way its fifth comes a minute after the first. One try in one and a half round trips
// is never a try before its answer could be there, and nothing that a link of any rate would notice.
[[nodiscard]] constexpr double FindLongestRetry(double roundTrip) {
  return roundTrip > 0.25 / 1.5 ? 1.5 * roundTrip : 0.25;
}

}  // namespace wobble::transport
