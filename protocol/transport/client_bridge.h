// The bridge of a client: one server, by the vestibule's handshake.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/transport/enet_host.h"
#include "protocol/transport/vestibule/caller.h"
#include "protocol/transport/vestibule/udp_socket.h"

namespace wobble::transport {

class ClientBridge {
 public:
  // addresses: of the server; all are asked, and the first to answer is it. Null with one line in `error`.
  [[nodiscard]] static std::unique_ptr<ClientBridge> Open(std::vector<NetAddress> addresses,
                                                          vestibule::Caller::Settings settings,
                                                          std::size_t maxReceivedBytes, std::string& error);
  ~ClientBridge();

  [[nodiscard]] ENetHost& Host() { return *m_host; }
  [[nodiscard]] const vestibule::Caller& Caller() const { return m_caller; }
  // Of ENet's only peer.
  static constexpr ENetAddress kServerAddress{1, 1};

  // Hands on what has arrived, and sends the handshake's datagrams that are due.
  void Poll(double now);
  // Sends what ENet has sent since the last call. To be called after each call of ENet that may send.
  void Flush();

  [[nodiscard]] std::uint64_t BytesIn() const { return m_bytesIn; }
  [[nodiscard]] std::uint64_t BytesOut() const { return m_bytesOut; }

 private:
  ClientBridge(vestibule::UdpSocket socket, std::vector<NetAddress> addresses, vestibule::Caller::Settings settings,
               std::size_t maxReceivedBytes);
  void TakeDatagram(const NetAddress& from, std::span<const std::uint8_t> datagram);
  void Send(std::span<const ENetBuffer> parts);
  void QueueDatagram();

  Bridge m_bridge;
  int m_pairEnd = -1;
  ENetHost* m_host;
  vestibule::UdpSocket m_socket;
  std::vector<NetAddress> m_addresses;  // one, once it has answered
  vestibule::Caller m_caller;
  vestibule::SendBatch m_batch;
  double m_now = 0;
  std::vector<std::uint8_t> m_datagram;                // scratch
  std::vector<std::span<const std::uint8_t>> m_parts;  // scratch
  std::uint64_t m_bytesIn = 0;
  std::uint64_t m_bytesOut = 0;
};

}  // namespace wobble::transport
