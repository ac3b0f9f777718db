// A client has no thread for this: its socket is read when it is polled.
#include "protocol/transport/client_bridge.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace wobble::transport {
namespace {

// A burst of snapshots and a blueprint's window may wait between two polls.
constexpr int kSocketBytes = 1024 * 1024;
// Batches of datagrams in one poll, so that a flood cannot keep it from returning.
constexpr int kMostBatches = 32;

}  // namespace

std::unique_ptr<ClientBridge> ClientBridge::Open(std::vector<NetAddress> addresses,
                                                 vestibule::Caller::Settings settings, std::size_t maxReceivedBytes,
                                                 std::string& error) {
  auto socket = vestibule::UdpSocket::Open(error);
  if (!socket) return nullptr;
  socket->SetBuffers(kSocketBytes);
  std::unique_ptr<ClientBridge> bridge(
      new ClientBridge(std::move(*socket), std::move(addresses), std::move(settings), maxReceivedBytes));
  if (bridge->m_host != nullptr) return bridge;
  error = std::string("the network library does not start: ") + std::strerror(errno);
  return nullptr;
}

ClientBridge::ClientBridge(vestibule::UdpSocket socket, std::vector<NetAddress> addresses,
                           vestibule::Caller::Settings settings, std::size_t maxReceivedBytes)
    : m_bridge{.receive =
                   [](ENetHost& host) {
                     host.receivedAddress = kServerAddress;
                     return true;
                   },
               .send = [this](enet_uint32, std::span<const ENetBuffer> parts) { Send(parts); }},
      m_host(MakeHost(m_bridge, 1, false, maxReceivedBytes, m_pairEnd)),
      m_socket(std::move(socket)),
      m_addresses(std::move(addresses)),
      m_caller(std::move(settings)) {}

ClientBridge::~ClientBridge() {
  Flush();
  if (m_host == nullptr) return;
  enet_host_destroy(m_host);
  close(m_pairEnd);
}

void ClientBridge::Poll(double now) {
  m_now = now;
  for (int i = 0; i < kMostBatches; ++i) {
    const std::size_t taken = m_socket.Receive(
        [&](const NetAddress& from, std::span<const std::uint8_t> datagram) { TakeDatagram(from, datagram); });
    if (taken < vestibule::UdpSocket::kBatch) break;
  }
  m_caller.FindDue(now, m_datagram);
  QueueDatagram();
  Flush();
}

void ClientBridge::TakeDatagram(const NetAddress& from, std::span<const std::uint8_t> datagram) {
  if (std::find(m_addresses.begin(), m_addresses.end(), from) == m_addresses.end()) return;
  m_bytesIn += datagram.size();
  const bool wasRequesting = m_caller.ReadState() == vestibule::Caller::State::kRequesting;
  const std::span<const std::uint8_t> plain = m_caller.TakeDatagram(datagram, m_now);
  if (wasRequesting && m_caller.ReadState() != vestibule::Caller::State::kRequesting) m_addresses = {from};
  // A pair that is full loses it, as a network would.
  if (!plain.empty()) static_cast<void>(send(m_pairEnd, plain.data(), plain.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

void ClientBridge::Send(std::span<const ENetBuffer> parts) {
  if (!m_caller.CanSeal()) return;
  m_parts.clear();
  for (const ENetBuffer& part : parts) {
    m_parts.emplace_back(static_cast<const std::uint8_t*>(part.data), part.dataLength);
  }
  m_caller.Seal(m_parts, m_now, m_datagram);
  QueueDatagram();
}

void ClientBridge::QueueDatagram() {
  if (m_datagram.empty()) return;
  for (const NetAddress& address : m_addresses) m_batch.Add(address, m_datagram);
}

void ClientBridge::Flush() {
  if (!m_batch.IsEmpty()) m_bytesOut += m_batch.Flush(m_socket);
}

}  // namespace wobble::transport
