// The socket of a service manager in this process: what NOTIFY_SOCKET names.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

namespace wobble::test {

class NoticeSocket {
 public:
  // name: a path, or an abstract name that begins with @.
  explicit NoticeSocket(std::string name)
      : m_name(std::move(name)), m_socket(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, m_name.data(), m_name.size());
    if (m_name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + m_name.size());
    EXPECT_EQ(bind(m_socket, reinterpret_cast<sockaddr*>(&address), size), 0) << m_name;
  }
  ~NoticeSocket() {
    close(m_socket);
    if (m_name[0] == '/') unlink(m_name.c_str());
  }
  NoticeSocket(const NoticeSocket&) = delete;
  NoticeSocket& operator=(const NoticeSocket&) = delete;

  [[nodiscard]] const std::string& Name() const { return m_name; }

  // The next notice; empty when none comes in time.
  [[nodiscard]] std::string Receive(int patienceMs) const {
    pollfd waiting{m_socket, POLLIN, 0};
    if (poll(&waiting, 1, patienceMs) <= 0) return "";
    char notice[256];
    const ssize_t size = recv(m_socket, notice, sizeof notice, 0);
    return {notice, static_cast<std::size_t>(size < 0 ? 0 : size)};
  }

 private:
  std::string m_name;
  int m_socket;
};

}  // namespace wobble::test
