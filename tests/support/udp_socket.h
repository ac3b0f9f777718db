// A plain UDP socket on the loopback interface, and the time, for tests with real sockets.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <vector>

namespace wobble::test {

using Bytes = std::vector<std::uint8_t>;

inline double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A socket on a port that the system picks.
class UdpSocket {
 public:
  UdpSocket() : m_handle(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in address = Loopback(0);
    EXPECT_EQ(bind(m_handle, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    getsockname(m_handle, reinterpret_cast<sockaddr*>(&address), &size);
    m_port = ntohs(address.sin_port);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  ~UdpSocket() { close(m_handle); }

  [[nodiscard]] std::uint16_t Port() const { return m_port; }
  void SendTo(std::uint16_t port, const Bytes& bytes) const {
    const sockaddr_in address = Loopback(port);
    sendto(m_handle, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  // Takes the next datagram; false when there is none.
  bool Receive(Bytes& bytes, std::uint16_t& from) const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    bytes.resize(65536);
    const ssize_t length =
        recvfrom(m_handle, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&address), &size);
    bytes.resize(length < 0 ? 0 : static_cast<std::size_t>(length));
    from = ntohs(address.sin_port);
    return length >= 0;
  }

 private:
  static sockaddr_in Loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

  int m_handle;
  std::uint16_t m_port = 0;
};

}  // namespace wobble::test
