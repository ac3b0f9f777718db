#include "tests/net/emulator/side.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <fstream>
#include <future>
#include <mutex>

namespace wobble::emulator {
namespace {

std::string Explain(const std::string& what) { return what + ": " + std::strerror(errno); }

ifreq NameDevice(const char* name) {
  ifreq request{};
  std::strncpy(request.ifr_name, name, IFNAMSIZ - 1);
  return request;
}

bool SwitchOn(int socket, const char* name) {
  ifreq request = NameDevice(name);
  if (ioctl(socket, SIOCGIFFLAGS, &request) < 0) return false;
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
  return ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

bool SetAddress(int socket, unsigned long call, const char* name, const std::string& address) {
  ifreq request = NameDevice(name);
  sockaddr_in value{};
  value.sin_family = AF_INET;
  if (inet_pton(AF_INET, address.c_str(), &value.sin_addr) != 1) return false;
  std::memcpy(&request.ifr_addr, &value, sizeof value);
  return ioctl(socket, call, &request) == 0;
}

// In the namespace of the calling thread. The device's descriptor; -1 with one line in `error`.
int OpenDevice(const SideSettings& settings, std::string& error) {
  constexpr const char* kName = "line";
  const int device = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (device < 0) return error = Explain("/dev/net/tun cannot be opened"), -1;
  ifreq request = NameDevice(kName);
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool isUp =
      ioctl(device, TUNSETIFF, &request) == 0 && SetAddress(socket, SIOCSIFADDR, kName, settings.address) &&
      SetAddress(socket, SIOCSIFNETMASK, kName, "255.255.255.0") && SwitchOn(socket, kName) && SwitchOn(socket, "lo");
  if (!isUp) error = Explain("the TUN device cannot be set up");
  close(socket);
  if (isUp) return device;
  close(device);
  return -1;
}

bool SetCongestion(const std::string& name, std::string& error) {
  if (name.empty()) return true;
  std::ofstream file("/proc/sys/net/ipv4/tcp_congestion_control");
  file << name << std::flush;
  if (!file) error = "the system has no congestion control \"" + name + "\"";
  return static_cast<bool>(file);
}

}  // namespace

struct Side::Queue {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::packaged_task<void()>> tasks;
  bool isOver = false;

  void Run() {
    std::unique_lock lock(mutex);
    while (!isOver) {
      std::vector<std::packaged_task<void()>> due;
      due.swap(tasks);
      lock.unlock();
      for (auto& task : due) task();
      lock.lock();
      changed.wait(lock, [this] { return isOver || !tasks.empty(); });
    }
  }
};

Side::Side() : m_queue(std::make_unique<Queue>()), m_thread([this] { m_queue->Run(); }) {}

std::unique_ptr<Side> Side::Open(const SideSettings& settings, std::string& error) {
  std::unique_ptr<Side> side(new Side);
  side->Do([&] {
    if (unshare(CLONE_NEWNET) != 0) {
      error = Explain("a network namespace cannot be made");
      return;
    }
    if (SetCongestion(settings.congestion, error)) side->m_device = OpenDevice(settings, error);
  });
  return side->m_device < 0 ? nullptr : std::move(side);
}

Side::~Side() {
  {
    const std::lock_guard lock(m_queue->mutex);
    m_queue->isOver = true;
  }
  m_queue->changed.notify_one();
  m_thread.join();
  if (m_device >= 0) close(m_device);
}

void Side::Do(const std::function<void()>& act) {
  std::packaged_task<void()> task(act);
  std::future<void> done = task.get_future();
  {
    const std::lock_guard lock(m_queue->mutex);
    m_queue->tasks.push_back(std::move(task));
  }
  m_queue->changed.notify_one();
  done.get();
}

pid_t Side::Start(const std::string& command) {
  pid_t child = -1;
  Do([&] {
    child = fork();
    if (child != 0) return;
    setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  });
  if (child > 0) setpgid(child, child);
  return child;
}

}  // namespace wobble::emulator
