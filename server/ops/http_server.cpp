// One thread that polls. cpp-httplib, which was here before, gives each connection a thread of its pool and has
// timeouts for each read alone: two connections that sent a byte now and then had both threads for good. Beast, which
// the gateway has, could do it, but a server is built without Boost, and four paths without keep-alive, bodies or
// headers that matter need little of HTTP.
#include "server/ops/http_server.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

namespace wobble::ops {
namespace {

// The longest wait while there are connections, ms: a clock that is not the system's may pass more quickly.
constexpr int kTurnMs = 50;

class Descriptor {
 public:
  explicit Descriptor(int descriptor = -1) : m_descriptor(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : m_descriptor(std::exchange(other.m_descriptor, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(m_descriptor, other.m_descriptor);
    return *this;
  }
  ~Descriptor() {
    if (m_descriptor >= 0) close(m_descriptor);
  }
  [[nodiscard]] int Get() const { return m_descriptor; }
  [[nodiscard]] bool IsOpen() const { return m_descriptor >= 0; }

 private:
  int m_descriptor;
};

//   kReading --> kAnswering --> kLingering --> kOver
//
// and from each of them to kOver at its deadline, or when the other end is gone.
struct Connection {
  enum class State {
    kReading,
    kAnswering,
    kLingering,  // what comes is dropped: to close over unread bytes could destroy the answer on its way
    kOver,
  };
  Descriptor socket;
  std::string address;  // by which connections are counted
  double endBy = 0;     // s
  State state = State::kReading;
  std::string request = {};
  std::string answer = {};
  std::size_t sent = 0;  // bytes of the answer
};
using State = Connection::State;

// The bytes of an IPv4 address, or the first eight of an IPv6 address, which is what a household gets.
std::string FindAddress(const sockaddr_storage& from) {
  if (from.ss_family == AF_INET) {
    const in_addr address = reinterpret_cast<const sockaddr_in&>(from).sin_addr;
    return {reinterpret_cast<const char*>(&address), sizeof address};
  }
  const in6_addr address = reinterpret_cast<const sockaddr_in6&>(from).sin6_addr;
  const std::string bytes(reinterpret_cast<const char*>(&address), sizeof address);
  return IN6_IS_ADDR_V4MAPPED(&address) ? bytes.substr(12) : bytes.substr(0, 8);
}

std::string_view Describe(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 431:
      return "Request Header Fields Too Large";
    default:
      return "Service Unavailable";
  }
}

std::string Write(const Answer& answer, bool hasBody) {
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n{}"
      "Connection: close\r\n\r\n{}",
      answer.status, Describe(answer.status), answer.type, answer.text.size(),
      answer.status == 405 ? "Allow: GET, HEAD\r\n" : "", hasBody ? answer.text : "");
}

// head: a request up to its empty line. All that matters of it is the first line: METHOD TARGET HTTP/1.x
std::string Reply(std::string_view head, const HttpServer::Responder& responder) {
  const std::string_view line = head.substr(0, head.find("\r\n"));
  const std::size_t first = line.find(' ');
  const std::size_t second = line.rfind(' ');
  if (first == std::string_view::npos || second == first || !line.substr(second + 1).starts_with("HTTP/1.") ||
      line[first + 1] != '/') {
    return Write({400, "this is no request\n"}, true);
  }
  const std::string_view method = line.substr(0, first);
  if (method != "GET" && method != "HEAD") return Write({405, "only GET and HEAD are answered here\n"}, true);
  const std::string_view target = line.substr(first + 1, second - first - 1);
  return Write(responder(target.substr(0, target.find('?'))), method == "GET");
}

// Bound and listening; none when that fails.
Descriptor OpenListener(const std::string& host, std::uint16_t port) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0) return Descriptor();
  Descriptor listener;
  for (const addrinfo* each = found; each != nullptr && !listener.IsOpen(); each = each->ai_next) {
    Descriptor socket(::socket(each->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const int yes = 1;
    if (socket.IsOpen() && setsockopt(socket.Get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
        bind(socket.Get(), each->ai_addr, each->ai_addrlen) == 0 && listen(socket.Get(), SOMAXCONN) == 0) {
      listener = std::move(socket);
    }
  }
  freeaddrinfo(found);
  return listener;
}

std::uint16_t FindPort(const Descriptor& listener) {
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  if (getsockname(listener.Get(), reinterpret_cast<sockaddr*>(&own), &size) != 0) return 0;
  return ntohs(own.ss_family == AF_INET ? reinterpret_cast<const sockaddr_in&>(own).sin_port
                                        : reinterpret_cast<const sockaddr_in6&>(own).sin6_port);
}

}  // namespace

struct HttpServer::Implementation {
  Responder responder;
  server::TimeSource clock;
  Descriptor listener;
  Descriptor wake;                           // readable when the thread is to end
  std::vector<Connection> connections = {};  // the oldest first
  std::vector<pollfd> waiting = {};
  bool canAccept = true;  // false for a turn when the system has no descriptor left
  std::thread thread = {};

  void Run();
  [[nodiscard]] bool Wait();  // false when the thread is to end
  void Accept(double now);
  void MakeRoom(const std::string& address);
  void Advance(Connection& connection, double now);
  void Read(Connection& connection, double now);
  void Send(Connection& connection, double now);
};

void HttpServer::Implementation::Run() {
  while (Wait()) {
    const double now = clock();
    // poll's list has two descriptors before the connections'.
    for (std::size_t i = 0; i < connections.size(); ++i) {
      if (waiting[i + 2].revents != 0) Advance(connections[i], now);
      if (now >= connections[i].endBy) connections[i].state = State::kOver;
    }
    std::erase_if(connections, [](const Connection& each) { return each.state == State::kOver; });
    canAccept = true;
    if (waiting[1].revents != 0) Accept(now);
  }
}

bool HttpServer::Implementation::Wait() {
  waiting = {{wake.Get(), POLLIN, 0}, {canAccept ? listener.Get() : -1, POLLIN, 0}};
  for (const Connection& each : connections) {
    const short events = each.state == State::kAnswering ? POLLOUT : POLLIN;
    waiting.push_back({each.socket.Get(), events, 0});
  }
  const bool mayRest = connections.empty() && canAccept;
  if (poll(waiting.data(), waiting.size(), mayRest ? -1 : kTurnMs) < 0) {
    for (pollfd& each : waiting) each.revents = 0;
  }
  return waiting[0].revents == 0;
}

// A turn takes in no more connections than there is room for, so that those it took in before are read between.
void HttpServer::Implementation::Accept(double now) {
  for (std::size_t i = 0; i < kMostOfAnAddress; ++i) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    Descriptor socket(accept4(listener.Get(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.IsOpen()) {
      canAccept = errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM;
      return;
    }
    std::string address = FindAddress(from);
    MakeRoom(address);
    connections.push_back({std::move(socket), std::move(address), now + kRequestTime});
  }
}

void HttpServer::Implementation::MakeRoom(const std::string& address) {
  const auto isOfIt = [&](const Connection& each) { return each.address == address; };
  const auto count = std::count_if(connections.begin(), connections.end(), isOfIt);
  if (static_cast<std::size_t>(count) >= kMostOfAnAddress) {
    connections.erase(std::find_if(connections.begin(), connections.end(), isOfIt));
  } else if (connections.size() >= kMostConnections) {
    connections.erase(connections.begin());
  }
}

void HttpServer::Implementation::Advance(Connection& connection, double now) {
  if (connection.state == State::kAnswering) return Send(connection, now);
  Read(connection, now);
}

void HttpServer::Implementation::Read(Connection& connection, double now) {
  char bytes[kMostRequestBytes];
  const ssize_t size = recv(connection.socket.Get(), bytes, sizeof bytes, 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) {
    connection.state = State::kOver;
    return;
  }
  if (connection.state == State::kLingering) return;
  // The empty line may have begun in what came before.
  const std::size_t from = connection.request.size() < 3 ? 0 : connection.request.size() - 3;
  connection.request.append(bytes, static_cast<std::size_t>(size));
  const std::size_t end = connection.request.find("\r\n\r\n", from);
  const bool isTooLarge = std::min(end, connection.request.size()) >= kMostRequestBytes;
  if (end == std::string::npos && !isTooLarge) return;
  connection.answer = isTooLarge ? Write({431, "too large a request\n"}, true)
                                 : Reply(std::string_view(connection.request).substr(0, end), responder);
  connection.state = State::kAnswering;
  connection.endBy = now + kAnswerTime;
  Send(connection, now);
}

void HttpServer::Implementation::Send(Connection& connection, double now) {
  const std::string_view rest = std::string_view(connection.answer).substr(connection.sent);
  const ssize_t size = send(connection.socket.Get(), rest.data(), rest.size(), MSG_NOSIGNAL);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size < 0) {
    connection.state = State::kOver;
    return;
  }
  connection.sent += static_cast<std::size_t>(size);
  if (connection.sent < connection.answer.size()) return;
  shutdown(connection.socket.Get(), SHUT_WR);
  connection.state = State::kLingering;
  connection.endBy = now + kLingerTime;
}

HttpServer::HttpServer(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}

std::unique_ptr<HttpServer> HttpServer::Listen(const std::string& host, std::uint16_t port, Responder responder,
                                               server::TimeSource clock, std::string& error) {
  std::unique_ptr<Implementation> made(new Implementation{
      std::move(responder), std::move(clock), OpenListener(host, port), Descriptor(eventfd(0, EFD_CLOEXEC))});
  if (!made->listener.IsOpen() || !made->wake.IsOpen()) {
    error =
        fmt::format("{}:{} (TCP): cannot be listened on; is it in use, or the address another machine's?", host, port);
    return nullptr;
  }
  made->thread = std::thread([server = made.get()] { server->Run(); });
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(made)));
}

HttpServer::~HttpServer() {
  eventfd_write(m->wake.Get(), 1);
  m->thread.join();
}

std::uint16_t HttpServer::ReadPort() const { return FindPort(m->listener); }

}  // namespace wobble::ops
