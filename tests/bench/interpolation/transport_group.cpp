#include "tests/bench/interpolation/transport_group.h"

namespace wobble::bench {

using transport::ConnectionId;

TransportGroup::TransportGroup(std::vector<std::unique_ptr<Transport>> members, std::shared_ptr<SentOfEach> sent)
    : m_members(std::move(members)), m_sent(std::move(sent)) {
  m_sent->resize(m_members.size());
}

ConnectionId TransportGroup::NumberIn(ConnectionId connection) const {
  return connection / static_cast<ConnectionId>(m_members.size());
}

void TransportGroup::Poll(double now, const Sink& sink) {
  const auto count = static_cast<ConnectionId>(m_members.size());
  for (ConnectionId member = 0; member < count; ++member) {
    m_members[member]->Poll(now, [&](const transport::Event& event) {
      transport::Event renamed = event;
      renamed.connection = event.connection * count + member;
      sink(renamed);
    });
  }
}

transport::SendResult TransportGroup::Send(ConnectionId connection, transport::Channel channel,
                                           std::span<const std::uint8_t> message) {
  const std::size_t member = MemberOf(connection);
  if (channel == transport::Channel::kSnapshot) {
    ++(*m_sent)[member].packets;
    (*m_sent)[member].bytes += message.size();
  }
  return m_members[member]->Send(NumberIn(connection), channel, message);
}

void TransportGroup::Disconnect(ConnectionId connection) {
  m_members[MemberOf(connection)]->Disconnect(NumberIn(connection));
}

void TransportGroup::Flush() {
  for (const auto& member : m_members) member->Flush();
}

double TransportGroup::ReadRoundTrip(ConnectionId connection) const {
  return m_members[MemberOf(connection)]->ReadRoundTrip(NumberIn(connection));
}

}  // namespace wobble::bench
