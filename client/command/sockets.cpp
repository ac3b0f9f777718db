#include "client/command/sockets.h"

#include <netdb.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace wobble::command {

void AllowManySockets() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  static_cast<void>(setrlimit(RLIMIT_NOFILE, &limit));  // a failure shows when sockets cannot be opened
}

bool IsFree(PortKind kind, const std::string& address, std::uint16_t port, std::string& error) {
  const bool isTcp = kind == PortKind::kTcp;
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_socktype = isTcp ? SOCK_STREAM : SOCK_DGRAM;
  addrinfo* found = nullptr;
  // The program that listens itself refuses what is no address.
  if (port == 0 || getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return true;
  const int descriptor = socket(found->ai_family, hints.ai_socktype | SOCK_CLOEXEC, 0);
  const int on = isTcp ? 1 : 0;  // connections that have just ended do not count
  const bool isFree = descriptor < 0 || (setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
                                         bind(descriptor, found->ai_addr, found->ai_addrlen) == 0 &&
                                         (!isTcp || listen(descriptor, 1) == 0));
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  freeaddrinfo(found);
  if (isFree) return true;
  error = "port " + std::to_string(port) + (isTcp ? " (TCP) " : " (UDP) ") +
          (reason == EADDRINUSE ? std::string("is in use")
                                : "cannot be listened at: " + std::string(std::strerror(reason)));
  return false;
}

}  // namespace wobble::command
