// A socket stays in the namespace in which it was made; who uses it may be elsewhere.
#include "tests/net/emulator/download.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <vector>

namespace wobble::emulator {

Download::Download(Side& server, Side& client, const std::string& serverAddress)
    : m_begin(std::chrono::steady_clock::now()) {
  int listener = -1;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, serverAddress.c_str(), &address.sin_addr);
  server.Do([&] {
    listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    listen(listener, 1);
    socklen_t length = sizeof address;
    getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length);
  });
  client.Do([&] {
    m_receiver = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    connect(m_receiver, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  });
  m_sender = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
  close(listener);
  m_sending = std::jthread([this] {
    const std::vector<char> bytes(1 << 16);
    while (send(m_sender, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0) {
    }
  });
  m_receiving = std::jthread([this] {
    std::vector<char> bytes(1 << 16);
    ssize_t size = 0;
    while ((size = recv(m_receiver, bytes.data(), bytes.size(), 0)) > 0) m_bytes += static_cast<std::uint64_t>(size);
  });
}

double Download::End() {
  if (m_sender < 0) return 0;
  shutdown(m_sender, SHUT_RDWR);
  shutdown(m_receiver, SHUT_RDWR);
  m_sending.join();
  m_receiving.join();
  close(m_sender);
  close(m_receiver);
  m_sender = -1;
  const std::chrono::duration<double> span = std::chrono::steady_clock::now() - m_begin;
  return 8 * static_cast<double>(m_bytes) / span.count();
}

}  // namespace wobble::emulator
