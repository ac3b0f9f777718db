// One connection at a time, each with a deadline: who may open the socket is trusted, but may hang.
#include "server/admin/admin_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace wobble::admin {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(2000);  // for a whole line, and for the server's answer
constexpr int kTurn = 100;                                   // ms until a stop is seen
constexpr std::size_t kMaxLineBytes = 1024;

bool MakeUnixAddress(const std::string& path, sockaddr_un& address, std::string& error) {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    error = path + ": must have 1 to " + std::to_string(sizeof address.sun_path - 1) + " bytes";
    return false;
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return true;
}

// Removes a socket that a server left behind which was killed; anything else stays.
bool RemoveStale(const sockaddr_un& address, std::string& error) {
  struct stat status {};
  if (lstat(address.sun_path, &status) != 0) return true;
  if (!S_ISSOCK(status.st_mode)) {
    error = std::string(address.sun_path) + ": is there, and is no socket";
    return false;
  }
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool isAlive = connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  if (isAlive) {
    error = std::string(address.sun_path) + ": another server answers there";
    return false;
  }
  unlink(address.sun_path);
  return true;
}

// False when the time is over or the far end closes.
bool ReadLine(int connection, std::string& line) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (line.find('\n') == std::string::npos && line.size() <= kMaxLineBytes) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd wait{connection, POLLIN, 0};
    if (left.count() <= 0 || poll(&wait, 1, static_cast<int>(left.count())) <= 0) return false;
    char bytes[256];
    const ssize_t count = recv(connection, bytes, sizeof bytes, 0);
    if (count < 0) return false;
    if (count == 0) break;  // the end of what is sent ends the line as well
    line.append(bytes, static_cast<std::size_t>(count));
  }
  // An empty line is answered; who says nothing at all only looks whether somebody is there.
  const bool isSaid = !line.empty();
  line = line.substr(0, line.find('\n'));
  return isSaid && line.size() <= kMaxLineBytes;
}

}  // namespace

std::unique_ptr<AdminSocket> AdminSocket::Listen(const std::string& path, OrderQueue& queue, std::string& error) {
  sockaddr_un address;
  if (!MakeUnixAddress(path, address, error) || !RemoveStale(address, error)) return nullptr;
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  // Nobody can connect before listen(), and by then only the owner may.
  if (listener < 0 || bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      chmod(path.c_str(), S_IRUSR | S_IWUSR) != 0 || listen(listener, 8) != 0) {
    error = path + ": " + std::strerror(errno);
    if (listener >= 0) close(listener);
    return nullptr;
  }
  return std::unique_ptr<AdminSocket>(new AdminSocket(path, listener, queue));
}

AdminSocket::AdminSocket(std::string path, int listener, OrderQueue& queue)
    : m_path(std::move(path)), m_listener(listener), m_queue(queue), m_thread([this] { Run(); }) {}

AdminSocket::~AdminSocket() {
  m_isStopping = true;
  m_thread.join();
  close(m_listener);
  unlink(m_path.c_str());
}

void AdminSocket::Run() {
  while (!m_isStopping) {
    pollfd wait{m_listener, POLLIN, 0};
    if (poll(&wait, 1, kTurn) <= 0) continue;
    const int connection = accept4(m_listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) continue;
    Serve(connection);
    close(connection);
  }
}

void AdminSocket::Serve(int connection) {
  std::string line;
  if (!ReadLine(connection, line)) return;
  const Answer answer = m_queue.Ask(std::move(line), "the administration", kPatience);
  std::string text = answer.isDone ? "ok\n" : "no\n";
  for (const std::string& each : answer.lines) text += each + "\n";
  const timeval patience{.tv_sec = 2, .tv_usec = 0};
  setsockopt(connection, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = send(connection, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return;
    sent += static_cast<std::size_t>(count);
  }
}

}  // namespace wobble::admin
