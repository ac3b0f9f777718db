// One browser's connection to the server, and the framing between the two.
//
// A message over the WebSocket is a byte that names the channel, and then the message as ENet carries it. Channel 3 is
// the link's own: a browser's ping of four bytes is answered with the same bytes and the round trip over ENet. On
// channel 4 the browser is given its ticket once, if the server gave one: with it it may come back. On channel 5 it is
// given once what it may open more WebSockets with.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "client/gateway/outbox.h"
#include "protocol/limits.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::gateway {

// The channel of pings, beside those of transport::Channel.
inline constexpr std::uint8_t kPingChannel = 3;
inline constexpr std::size_t kPingBytes = 4;
// The channel on which the browser gets, once, what it may come back with as a token.
inline constexpr std::uint8_t kTicketChannel = 4;
// The channel of the key of its lanes.
inline constexpr std::uint8_t kLaneChannel = 5;
using LaneKey = std::array<std::uint8_t, 16>;

// The largest message that a browser may send, bytes.
inline constexpr std::size_t kMaxBrowserMessageBytes = 1 + protocol::kMaxClientMessageBytes;

// The WebSocket subprotocol, with the protocol's version: "wobble.6".
[[nodiscard]] std::string MakeSubprotocol();

class ServerLink {
 public:
  // Begins to connect. host: numeric, so that nothing is looked up here. Null with one line in `error` when there is no
  // socket.
  [[nodiscard]] static std::unique_ptr<ServerLink> Open(const std::string& host, std::uint16_t port,
                                                        const transport::ConnectOptions& options, std::string& error);

  // Takes in what the server has sent and adds it to the browser's outbox.
  void Poll(double now, Outbox& outbox);

  enum class Verdict { kGood, kTooLarge, kNotUnderstood };
  // Passes on a message of the browser, or answers it at once. Only while IsConnected.
  [[nodiscard]] Verdict Take(std::span<const std::uint8_t> message, Outbox& outbox);

  // Disconnects from the server. Poll is then to be called until HasEnded, three seconds at most.
  void Leave();

  // Whether the server has ever let the browser in.
  [[nodiscard]] bool IsConnected() const { return m_isConnected; }
  [[nodiscard]] bool HasEnded() const { return m_hasEnded; }
  // Once it has ended: a line for the player, and whether the server would say the same to another try.
  [[nodiscard]] const std::string& EndReason() const { return m_endReason; }
  [[nodiscard]] bool IsFinal() const { return m_isFinal; }
  // Why the server did not let the browser in.
  [[nodiscard]] transport::vestibule::Refusal ReadRefusal() const { return m_transport->ReadRefusal(); }
  [[nodiscard]] bool ServerWantsCredential() const { return m_transport->ServerWantsCredential(); }

 private:
  explicit ServerLink(std::unique_ptr<transport::EnetTransport> transport) : m_transport(std::move(transport)) {}

  void PassTicket(Outbox& outbox);
  void AnswerPing(std::span<const std::uint8_t> bytes, Outbox& outbox) const;

  std::unique_ptr<transport::EnetTransport> m_transport;
  bool m_isConnected = false;
  bool m_hasPassedTicket = false;
  bool m_hasEnded = false;
  std::string m_endReason;
  bool m_isFinal = false;
};

}  // namespace wobble::gateway
