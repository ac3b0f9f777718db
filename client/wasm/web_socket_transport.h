// The Transport of the page: messages go through a WebSocket that the page's script owns.
//
// The script reports that the socket has opened or closed, puts in the messages that came and takes out those to send;
// nothing here calls the script. So the same code runs in a browser, under Node with recorded bytes and natively in a
// test.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "protocol/transport/transport.h"

namespace wobble::wasm {

class WebSocketTransport final : public transport::Transport {
 public:
  static constexpr transport::ConnectionId kConnection = 1;

  // Called by the script. A message is a byte that names the channel, and then the message as ENet carries it.
  void Open() { m_hasOpened = true; }
  void Close() { m_hasClosed = true; }
  void Receive(std::span<const std::uint8_t> message);
  // The round trip to the game's server, seconds.
  void SetRoundTrip(double seconds) { m_roundTrip = seconds; }
  // The oldest message to send; empty when there is none. Valid until TakeOutgoing, which drops it.
  [[nodiscard]] std::span<const std::uint8_t> FindOutgoing() const;
  void TakeOutgoing();
  // Whether the client has disconnected: the script closes the socket once there is nothing to send.
  [[nodiscard]] bool IsCloseAsked() const { return m_isCloseAsked; }

  void Poll(double now, const Sink& sink) override;
  [[nodiscard]] transport::SendResult Send(transport::ConnectionId connection, transport::Channel channel,
                                           std::span<const std::uint8_t> message) override;
  void Disconnect(transport::ConnectionId connection) override;
  void Flush() override {}
  [[nodiscard]] transport::Statistics ReadStatistics() const override { return m_statistics; }
  [[nodiscard]] double ReadRoundTrip(transport::ConnectionId) const override { return m_roundTrip; }

 private:
  enum class State { kConnecting, kOpen, kClosed };
  using Bytes = std::vector<std::uint8_t>;
  // The bytes are stored without the channel, because FlatBuffers needs them aligned.
  struct Incoming {
    transport::Channel channel;
    Bytes bytes;
  };

  State m_state = State::kConnecting;  // as the client has been told
  bool m_hasOpened = false;
  bool m_hasClosed = false;
  bool m_isCloseAsked = false;
  double m_roundTrip = 0;
  std::deque<Incoming> m_incoming;
  std::deque<Bytes> m_outgoing;
  transport::Statistics m_statistics;
};

}  // namespace wobble::wasm
