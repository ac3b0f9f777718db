// A UDP socket for IPv6 and IPv4 alike, which receives and sends many datagrams with one system call.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/transport/net_address.h"

namespace wobble::transport::vestibule {

// Larger datagrams are cut, and then fail to be opened. Ours are at most kMaxDatagramBytes (enet_host.h).
inline constexpr std::size_t kReceivedBytes = 1500;

class UdpSocket {
 public:
  // host: the address to listen at, a number or a name; empty: all addresses of the machine, IPv6 and IPv4. port: 0: a
  // free one. nullopt with one line in `error` when the port cannot be bound.
  [[nodiscard]] static std::optional<UdpSocket> Listen(const std::string& host, std::uint16_t port, std::string& error);
  // For a client.
  [[nodiscard]] static std::optional<UdpSocket> Open(std::string& error);
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&&) = delete;
  ~UdpSocket();

  [[nodiscard]] int Descriptor() const { return m_descriptor; }
  [[nodiscard]] std::uint16_t ReadPort() const;
  // Silently limited by the system's maximum.
  void SetBuffers(int bytes);

  // Passes what has arrived to `take`, at most kBatch datagrams. Returns how many.
  static constexpr std::size_t kBatch = 64;
  using TakeFunction = std::function<void(const NetAddress& from, std::span<const std::uint8_t> datagram)>;
  std::size_t Receive(const TakeFunction& take) { return Receive(take, false); }
  // The same, and waits for the first for as long as SetPatience says.
  std::size_t Await(const TakeFunction& take) { return Receive(take, true); }
  void SetPatience(double seconds);

 private:
  std::size_t Receive(const TakeFunction& take, bool waits);

  struct Inbox;
  explicit UdpSocket(int descriptor, bool isIpv6);
  friend class SendBatch;

  int m_descriptor;
  bool m_isIpv6;
  std::unique_ptr<Inbox> m_inbox;
};

// Datagrams that leave with one call. Each thread that sends has its own.
class SendBatch {
 public:
  void Add(const NetAddress& to, std::span<const std::uint8_t> datagram);
  // Sends all. A datagram that the system refuses is dropped, like one that the network loses. Returns the bytes sent.
  std::uint64_t Flush(const UdpSocket& socket);
  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }
  [[nodiscard]] bool IsFull() const { return m_entries.size() >= UdpSocket::kBatch; }

 private:
  struct Entry {
    NetAddress to;
    std::size_t begin;
    std::size_t size;
  };
  std::vector<Entry> m_entries;
  std::vector<std::uint8_t> m_bytes;
};

// The addresses of a server, IPv6 and IPv4 in the system's order, at most kMaxAddresses. May block for as long as the
// system's resolver does. Empty with one line in `error` when there is none.
inline constexpr std::size_t kMaxAddresses = 4;
[[nodiscard]] std::vector<NetAddress> ResolveAddresses(const std::string& host, std::uint16_t port, std::string& error);

}  // namespace wobble::transport::vestibule
