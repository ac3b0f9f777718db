// Runs a relay by the clock, in this thread or in one of its own.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "protocol/transport/relay.h"

namespace wobble::link {

// Runs the relay until isDone returns true. It is called at least 20 times a second with the seconds since the start.
void RunRelay(transport::Relay& relay, const std::function<bool(double now)>& isDone);

// Three lines, "up: 1200 received, ...", "down: ..." and "players: ...", each after `prefix` and with its newline.
[[nodiscard]] std::string DescribeCounts(const transport::RelayCounts& counts, const std::string& prefix);

class RelayThread {
 public:
  // Takes an open relay and starts it.
  explicit RelayThread(std::unique_ptr<transport::Relay> relay);
  ~RelayThread();

  // The UDP port to connect to, on this machine.
  [[nodiscard]] std::uint16_t ReadPort() const { return m_port; }
  // Stops the relay and returns its counts.
  const transport::RelayCounts& Stop();

 private:
  std::unique_ptr<transport::Relay> m_relay;
  std::uint16_t m_port;
  std::atomic<bool> m_stop{false};
  std::thread m_thread;  // last: it uses the other members
};

}  // namespace wobble::link
