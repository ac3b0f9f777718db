// The bridge of a server: visitors that the door has let in to ENet's peers, and back.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "protocol/transport/enet_host.h"
#include "protocol/transport/vestibule/doorkeeper.h"

namespace wobble::transport {

class ServerBridge {
 public:
  // Listens at the socket, and makes the host. Null with one line in `error`.
  [[nodiscard]] static std::unique_ptr<ServerBridge> Open(vestibule::UdpSocket socket,
                                                          vestibule::Door::Settings settings,
                                                          std::size_t maxReceivedBytes, std::string& error);
  ~ServerBridge();

  [[nodiscard]] ENetHost& Host() { return *m_host; }
  [[nodiscard]] vestibule::Doorkeeper& Keeper() { return *m_keeper; }
  [[nodiscard]] const vestibule::Doorkeeper& Keeper() const { return *m_keeper; }
  // A peer's address names its visitor.
  [[nodiscard]] static vestibule::VisitorId FindVisitor(const ENetPeer& peer) { return peer.address.host; }

  // Null for a visitor that is gone.
  [[nodiscard]] const Admission* FindAdmission(vestibule::VisitorId visitor) const;

  // Sends what ENet has sent since the last call. To be called after each call of ENet that may send.
  void Flush();
  // Forgets a visitor whose peer is gone.
  void Remove(vestibule::VisitorId visitor);

  // Visitors to be sent away, since the last call.
  struct Notice {
    vestibule::VisitorId visitor = 0;
    bool isGone = false;  // the door has removed it; else it sent what no honest client sends
  };
  [[nodiscard]] std::vector<Notice> TakeNotices() { return std::exchange(m_notices, {}); }

  [[nodiscard]] std::uint64_t BytesOut() const { return m_bytesOut; }

 private:
  explicit ServerBridge(std::size_t slots, std::size_t maxReceivedBytes, int& pairEnd);
  bool Receive(ENetHost& host);
  bool TakeData(ENetHost& host, vestibule::VisitorId visitor);
  void Send(enet_uint32 connection, std::span<const ENetBuffer> parts);

  struct Leg {
    NetAddress address;
    std::uint32_t session = 0;
    vestibule::Sealer sealer;
    enet_uint32 connection = 0;  // of ENet; 0 before its CONNECT
    Admission admission = {};
  };

  Bridge m_bridge;
  ENetHost* m_host;
  std::unique_ptr<vestibule::Doorkeeper> m_keeper;
  std::unordered_map<vestibule::VisitorId, Leg> m_legs;
  std::unordered_map<enet_uint32, vestibule::VisitorId> m_byConnection;
  std::vector<Notice> m_notices;
  vestibule::SendBatch m_batch;
  std::vector<std::uint8_t> m_datagram;                // scratch
  std::vector<std::span<const std::uint8_t>> m_parts;  // scratch
  std::uint64_t m_bytesOut = 0;
};

}  // namespace wobble::transport
