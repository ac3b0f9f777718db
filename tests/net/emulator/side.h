// One end of an emulated line: a network namespace of its own, with a TUN device as its only way out.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace wobble::emulator {

struct SideSettings {
  std::string address;     // IPv4, of the device; both ends are in its /24
  std::string congestion;  // of TCP; empty: the system's
};

// Namespaces belong to threads: what this end does, it does on a thread of its own, which lives as long as the side.
class Side {
 public:
  // Null with one line in `error` where the system does not permit it.
  [[nodiscard]] static std::unique_ptr<Side> Open(const SideSettings& settings, std::string& error);
  ~Side();
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;

  // The device: each read gives one IP packet that leaves this end, each write brings one in. It does not block.
  [[nodiscard]] int Device() const { return m_device; }
  // Starts `sh -c command` in this end, as the leader of a process group. Its process id; -1: it cannot be started.
  [[nodiscard]] pid_t Start(const std::string& command);
  // Runs something in this end, and waits for it.
  void Do(const std::function<void()>& act);

 private:
  struct Queue;
  Side();

  int m_device = -1;
  std::unique_ptr<Queue> m_queue;
  std::thread m_thread;
};

}  // namespace wobble::emulator
