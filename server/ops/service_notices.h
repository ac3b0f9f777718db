// Tells systemd that the server is ready, that its loop still turns, and that it ends: sd_notify(3) and the units'
// options Type=notify and WatchdogSec=.
//
// The protocol is one datagram of text to the socket that NOTIFY_SOCKET names, which its manual offers for programs to
// send by themselves. libsystemd was rejected: for that datagram it would be one more package to build with, and load
// itself and five libraries into every server, also where there is no systemd.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <limits>
#include <string>

namespace wobble::ops {

class ServiceNotices {
 public:
  // socket: a path, or an abstract name that begins with @; empty: nobody is told anything. watchdog: s after which
  // systemd takes a silent server for hung; 0: never.
  ServiceNotices(const std::string& socket, double watchdog);
  // As the environment says: NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  static ServiceNotices FromEnvironment();
  ~ServiceNotices();
  ServiceNotices(const ServiceNotices&) = delete;
  ServiceNotices& operator=(const ServiceNotices&) = delete;

  // None of these waits. What cannot be sent is dropped, and the log says so the first time.
  void TellReady();
  // Call it in every turn of the loop; two notices are sent in each time of the watchdog. now: s.
  void TellAlive(double now);
  void TellEnding();

 private:
  void Send(const char* notice);

  int m_socket = -1;
  sockaddr_un m_address{};
  socklen_t m_size = 0;  // of m_address
  double m_interval;     // of signs of life, s; 0: none
  double m_nextSign = -std::numeric_limits<double>::infinity();
  bool m_hasFailed = false;
};

}  // namespace wobble::ops
