#include "server/ops/service_notices.h"

#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace wobble::ops {
namespace {

// 0 when there is none, or it is no number.
long long ReadNumber(const char* variable) {
  const char* const text = std::getenv(variable);
  long long number = 0;
  if (text != nullptr) std::from_chars(text, text + std::strlen(text), number);
  return number;
}

}  // namespace

ServiceNotices ServiceNotices::FromEnvironment() {
  const char* const socket = std::getenv("NOTIFY_SOCKET");
  const long long process = ReadNumber("WATCHDOG_PID");
  const bool isWatched = process == 0 || process == getpid();  // it may be meant for a parent
  return {socket == nullptr ? "" : socket, isWatched ? static_cast<double>(ReadNumber("WATCHDOG_USEC")) * 1e-6 : 0};
}

ServiceNotices::ServiceNotices(const std::string& socket, double watchdog) : m_interval(watchdog / 2) {
  if (socket.empty()) return;
  if ((socket[0] != '/' && socket[0] != '@') || socket.size() >= sizeof m_address.sun_path) {
    spdlog::warn("NOTIFY_SOCKET {}: must be a path or a name with @ of at most {} bytes; systemd is told nothing",
                 socket, sizeof m_address.sun_path - 1);
    return;
  }
  m_address.sun_family = AF_UNIX;
  std::memcpy(m_address.sun_path, socket.data(), socket.size());
  if (socket[0] == '@') m_address.sun_path[0] = '\0';
  m_size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket.size());
  m_socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

ServiceNotices::~ServiceNotices() {
  if (m_socket >= 0) close(m_socket);
}

void ServiceNotices::TellReady() { Send("READY=1"); }

void ServiceNotices::TellAlive(double now) {
  if (m_interval <= 0 || now < m_nextSign) return;
  m_nextSign = now + m_interval;
  Send("WATCHDOG=1");
}

void ServiceNotices::TellEnding() { Send("STOPPING=1"); }

void ServiceNotices::Send(const char* notice) {
  if (m_socket < 0) return;
  const auto* const address = reinterpret_cast<const sockaddr*>(&m_address);
  const std::size_t size = std::strlen(notice);
  if (sendto(m_socket, notice, size, MSG_NOSIGNAL, address, m_size) == static_cast<ssize_t>(size) || m_hasFailed)
    return;
  m_hasFailed = true;
  spdlog::warn("systemd is not told {}: {}", notice, std::strerror(errno));
}

}  // namespace wobble::ops
