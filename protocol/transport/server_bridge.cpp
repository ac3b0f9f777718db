// ENet finds a peer by address, so each visitor gets one of its own, which is its number. On the way out ENet tells
// only the id of a connection, which the client has chosen: a CONNECT with an id that another visitor has is dropped,
// or datagrams would be sealed to the wrong client.
#include "protocol/transport/server_bridge.h"

#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstring>
#include <utility>

namespace wobble::transport {
namespace {

using vestibule::PairHead;

constexpr enet_uint16 kAnyPort = 1;

// The id in a datagram that begins with a CONNECT, as ENet stores it; 0 for other datagrams. The door has seen to it
// that such a datagram is whole.
enet_uint32 FindConnect(const ENetHost& host) {
  const bool hasTime = (host.receivedData[0] & (ENET_PROTOCOL_HEADER_FLAG_SENT_TIME >> 8U)) != 0;
  const std::size_t at = (hasTime ? sizeof(ENetProtocolHeader) : sizeof(enet_uint16)) + sizeof(enet_uint32);
  const bool isConnect = host.receivedDataLength >= at + sizeof(ENetProtocolConnect) &&
                         (host.receivedData[at] & ENET_PROTOCOL_COMMAND_MASK) == ENET_PROTOCOL_COMMAND_CONNECT;
  if (!isConnect) return 0;
  enet_uint32 connection;
  std::memcpy(&connection, host.receivedData + at + offsetof(ENetProtocolConnect, connectID), sizeof connection);
  return connection;
}

}  // namespace

std::unique_ptr<ServerBridge> ServerBridge::Open(vestibule::UdpSocket socket, vestibule::Door::Settings settings,
                                                 std::size_t maxReceivedBytes, std::string& error) {
  int pairEnd = -1;
  const std::size_t slots = vestibule::CountSlots(settings.maxVisitors);
  std::unique_ptr<ServerBridge> bridge(new ServerBridge(slots, maxReceivedBytes, pairEnd));
  if (bridge->m_host == nullptr) {
    error = std::string("the network library does not start: ") + std::strerror(errno);
    return nullptr;
  }
  bridge->m_keeper =
      std::make_unique<vestibule::Doorkeeper>(std::move(socket), vestibule::Door(std::move(settings)), pairEnd);
  return bridge;
}

ServerBridge::ServerBridge(std::size_t slots, std::size_t maxReceivedBytes, int& pairEnd)
    : m_bridge{.receive = [this](ENetHost& host) { return Receive(host); },
               .send = [this](enet_uint32 connection, std::span<const ENetBuffer> parts) { Send(connection, parts); }},
      m_host(MakeHost(m_bridge, slots, true, maxReceivedBytes, pairEnd)) {}

ServerBridge::~ServerBridge() {
  Flush();
  if (m_host != nullptr) enet_host_destroy(m_host);
}

void ServerBridge::Flush() {
  if (!m_batch.IsEmpty()) m_bytesOut += m_batch.Flush(m_keeper->Socket());
}

const Admission* ServerBridge::FindAdmission(vestibule::VisitorId visitor) const {
  const auto leg = m_legs.find(visitor);
  return leg == m_legs.end() ? nullptr : &leg->second.admission;
}

void ServerBridge::Remove(vestibule::VisitorId visitor) {
  m_keeper->Remove(visitor);
  const auto leg = m_legs.find(visitor);
  if (leg == m_legs.end()) return;
  m_byConnection.erase(leg->second.connection);
  m_legs.erase(leg);
}

bool ServerBridge::Receive(ENetHost& host) {
  PairHead head;
  if (host.receivedDataLength < sizeof head) return false;
  std::memcpy(&head, host.receivedData, sizeof head);
  host.receivedData += sizeof head;
  host.receivedDataLength -= sizeof head;
  switch (head.kind) {
    case PairHead::Kind::kNew: {
      vestibule::Door::Leg leg;
      assert(host.receivedDataLength == sizeof leg);
      std::memcpy(&leg, host.receivedData, sizeof leg);
      m_legs[head.visitor] = {.address = leg.address,
                              .session = leg.session,
                              .sealer = vestibule::Sealer(leg.toClient),
                              .connection = 0,
                              .admission = leg.admission};
      return false;
    }
    case PairHead::Kind::kData:
      return TakeData(host, head.visitor);
    case PairHead::Kind::kOffence:
      m_notices.push_back({.visitor = head.visitor, .isGone = false});
      return false;
    case PairHead::Kind::kGone:
      m_notices.push_back({.visitor = head.visitor, .isGone = true});
      return false;
  }
  return false;
}

bool ServerBridge::TakeData(ENetHost& host, vestibule::VisitorId visitor) {
  const auto leg = m_legs.find(visitor);
  if (leg == m_legs.end()) return false;  // removed while this was on its way
  if (const enet_uint32 connection = FindConnect(host); connection != 0) {
    const auto [known, isNew] = m_byConnection.try_emplace(connection, visitor);
    if (known->second != visitor) return false;
    if (isNew) leg->second.connection = connection;
  }
  host.receivedAddress = {visitor, kAnyPort};
  return true;
}

void ServerBridge::Send(enet_uint32 connection, std::span<const ENetBuffer> parts) {
  const auto visitor = m_byConnection.find(connection);
  if (visitor == m_byConnection.end()) return;
  Leg& leg = m_legs.at(visitor->second);
  m_parts.clear();
  for (const ENetBuffer& part : parts) {
    m_parts.emplace_back(static_cast<const std::uint8_t*>(part.data), part.dataLength);
  }
  m_datagram.clear();
  leg.sealer.Seal(vestibule::SealedKind::kData, leg.session, m_parts, m_datagram);
  m_batch.Add(leg.address, m_datagram);
}

}  // namespace wobble::transport
