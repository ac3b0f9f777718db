// The relay does not parse what it carries: a new message needs no new gateway, and a browser's bytes are judged in one
// place, by the server.
#include "client/gateway/server_link.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wobble::gateway {
namespace {

using transport::Channel;
using transport::EnetTransport;
using transport::SendResult;

}  // namespace

std::string MakeSubprotocol() { return "wobble." + std::to_string(protocol::kProtocolVersion); }

std::unique_ptr<ServerLink> ServerLink::Open(const std::string& host, std::uint16_t port,
                                             const transport::ConnectOptions& options, std::string& error) {
  auto transport = EnetTransport::Connect(host, port, error, options);
  return transport == nullptr ? nullptr : std::unique_ptr<ServerLink>(new ServerLink(std::move(transport)));
}

void ServerLink::Poll(double now, Outbox& outbox) {
  m_transport->Poll(now, [&](const transport::Event& event) {
    switch (event.kind) {
      case transport::Event::Kind::kConnected:
        m_isConnected = true;
        break;
      case transport::Event::Kind::kDisconnected:
        m_hasEnded = true;
        m_isFinal = event.isFinal;
        m_endReason = !event.reason.empty() ? std::string(event.reason)
                      : m_isConnected       ? "the server has ended the connection"
                                            : "the server does not answer";
        break;
      case transport::Event::Kind::kMessage:
        if (event.channel == Channel::kSnapshot) {
          outbox.AddSnapshot(event.bytes, now);
        } else {
          outbox.Add(static_cast<std::uint8_t>(event.channel), event.bytes);
        }
        break;
      case transport::Event::Kind::kOffence:  // of clients alone
        break;
    }
  });
  if (m_isConnected && !m_hasPassedTicket) PassTicket(outbox);
}

// The answer that brings it may be lost, and then comes after ENet's first datagrams.
void ServerLink::PassTicket(Outbox& outbox) {
  const std::vector<std::uint8_t> ticket = m_transport->ReadTicket();
  if (ticket.empty()) return;
  outbox.Add(kTicketChannel, ticket);
  m_hasPassedTicket = true;
}

ServerLink::Verdict ServerLink::Take(std::span<const std::uint8_t> message, Outbox& outbox) {
  if (message.empty()) return Verdict::kNotUnderstood;
  const std::uint8_t channel = message[0];
  const std::span<const std::uint8_t> bytes = message.subspan(1);
  if (channel == kPingChannel) {
    if (bytes.size() != kPingBytes) return Verdict::kNotUnderstood;
    AnswerPing(bytes, outbox);
    return Verdict::kGood;
  }
  if (channel != static_cast<std::uint8_t>(Channel::kControl) &&
      channel != static_cast<std::uint8_t>(Channel::kInput)) {
    return Verdict::kNotUnderstood;
  }
  const SendResult result = m_transport->Send(EnetTransport::kClientConnection, static_cast<Channel>(channel), bytes);
  m_transport->Flush();
  return result == SendResult::kTooLarge ? Verdict::kTooLarge : Verdict::kGood;  // a link that has ended shows in Poll
}

void ServerLink::AnswerPing(std::span<const std::uint8_t> bytes, Outbox& outbox) const {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  const double roundTrip = 1000 * m_transport->ReadRoundTrip(EnetTransport::kClientConnection);
  const auto milliseconds = static_cast<std::uint16_t>(std::lround(std::min(roundTrip, kMost)));
  Outbox::Message answer(bytes.begin(), bytes.end());
  answer.push_back(static_cast<std::uint8_t>(milliseconds & 0xff));
  answer.push_back(static_cast<std::uint8_t>(milliseconds >> 8));
  outbox.Add(kPingChannel, answer);
}

void ServerLink::Leave() {
  m_transport->Disconnect(EnetTransport::kClientConnection);
  m_transport->Flush();
}

}  // namespace wobble::gateway
