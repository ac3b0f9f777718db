// The relay with a clock: in this thread, or in one of its own beside what goes through it.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "protocol/transport/relay.h"

namespace wobble::link {

// Until isDone, which is asked at least 20 times a second with the seconds since the call, returns true.
void RunRelay(transport::Relay& relay, const std::function<bool(double now)>& isDone);

// Three lines, "up: 1200 received, ...", "down: ..." and "players: ...", each after `prefix` and with its newline.
[[nodiscard]] std::string DescribeCounts(const transport::RelayCounts& counts, const std::string& prefix);

class RelayThread {
 public:
  // Takes an open relay and begins.
  explicit RelayThread(std::unique_ptr<transport::Relay> relay);
  ~RelayThread();

  // Where to connect to, on this machine.
  [[nodiscard]] std::uint16_t ReadPort() const { return m_port; }
  // Ends the relay; what it counted.
  const transport::RelayCounts& Stop();

 private:
  std::unique_ptr<transport::Relay> m_relay;
  std::uint16_t m_port;
  std::atomic<bool> m_stop{false};
  std::thread m_thread;  // last: it uses the others
};

}  // namespace wobble::link
