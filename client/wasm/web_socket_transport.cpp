// Both queues are bounded. When the script stops or the socket is stuck, inputs and snapshots are lost, which later
// ones replace anyway; a control message too many ends the connection, since it must not lose one.
#include "client/wasm/web_socket_transport.h"

#include <utility>

#include "protocol/limits.h"

namespace wobble::wasm {
namespace {

constexpr std::size_t kMaxQueued = 4096;  // messages, each way
constexpr std::size_t kChannelByte = 1;

}  // namespace

void WebSocketTransport::Receive(std::span<const std::uint8_t> message) {
  m_statistics.bytesIn += message.size();
  const bool isWhole = message.size() > kChannelByte && message[0] < transport::kChannelCount &&
                       message.size() <= protocol::kMaxServerMessageBytes + kChannelByte;
  if (!isWhole) {
    ++m_statistics.messagesRejected;
    return;
  }
  if (m_incoming.size() < kMaxQueued) {
    m_incoming.push_back(
        {static_cast<transport::Channel>(message[0]), {message.begin() + kChannelByte, message.end()}});
  } else if (message[0] == static_cast<std::uint8_t>(transport::Channel::kControl)) {
    Close();
  }
}

std::span<const std::uint8_t> WebSocketTransport::FindOutgoing() const {
  return m_outgoing.empty() ? std::span<const std::uint8_t>() : m_outgoing.front();
}

void WebSocketTransport::TakeOutgoing() {
  if (!m_outgoing.empty()) m_outgoing.pop_front();
}

void WebSocketTransport::Poll(double, const Sink& sink) {
  using Kind = transport::Event::Kind;
  if (m_state == State::kConnecting && m_hasOpened) {
    m_state = State::kOpen;
    sink({.kind = Kind::kConnected, .connection = kConnection});
  }
  while (!m_incoming.empty()) {
    const Incoming message = std::move(m_incoming.front());
    m_incoming.pop_front();
    sink({.kind = Kind::kMessage, .connection = kConnection, .channel = message.channel, .bytes = message.bytes});
  }
  if (m_state != State::kClosed && m_hasClosed) {
    m_state = State::kClosed;
    sink({.kind = Kind::kDisconnected, .connection = kConnection});
  }
}

transport::SendResult WebSocketTransport::Send(transport::ConnectionId connection, transport::Channel channel,
                                               std::span<const std::uint8_t> message) {
  using transport::SendResult;
  if (connection != kConnection) return SendResult::kUnknownConnection;
  if (message.size() > protocol::kMaxClientMessageBytes) return SendResult::kTooLarge;
  if (m_state != State::kOpen || m_isCloseAsked || m_outgoing.size() >= kMaxQueued) return SendResult::kFailed;
  Bytes& bytes = m_outgoing.emplace_back();
  bytes.reserve(kChannelByte + message.size());
  bytes.push_back(static_cast<std::uint8_t>(channel));
  bytes.insert(bytes.end(), message.begin(), message.end());
  m_statistics.bytesOut += bytes.size();
  return SendResult::kQueued;
}

void WebSocketTransport::Disconnect(transport::ConnectionId connection) {
  if (connection == kConnection) m_isCloseAsked = true;
}

}  // namespace wobble::wasm
