// Any bytes to the HTTP of --ops, to the gateway's, and behind a WebSocket's handshake to the gateway, over loopback.
// Both answer or close, and answer the next request.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <string>
#include <thread>

#include "client/gateway/gateway.h"
#include "client/gateway/server_link.h"
#include "server/ops/http_listener.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

constexpr int kPatience = 100;  // ms until a connection that waits for more is given up here

int Connect(std::uint16_t port) {
  const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in server{};
  server.sin_family = AF_INET;
  server.sin_port = htons(port);
  server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool isGood = connect(connection, reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0;
  // No TIME_WAIT: there are thousands of these a minute.
  const linger atOnce{.l_onoff = 1, .l_linger = 0};
  setsockopt(connection, SOL_SOCKET, SO_LINGER, &atOnce, sizeof atOnce);
  Require(isGood);
  return connection;
}

std::string Exchange(std::uint16_t port, const std::string& bytes, bool ends) {
  const int connection = Connect(port);
  static_cast<void>(send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL));
  if (ends) shutdown(connection, SHUT_WR);
  std::string answer;
  char block[4096];
  for (pollfd wait{connection, POLLIN, 0}; answer.size() < 100000 && poll(&wait, 1, kPatience) > 0;) {
    const ssize_t count = recv(connection, block, sizeof block, 0);
    if (count <= 0) break;
    answer.append(block, static_cast<std::size_t>(count));
  }
  close(connection);
  return answer;
}

// Both servers, on threads that end with the program.
struct Servers {
  Servers() {
    std::string error;
    ops = ops::HttpListener::Listen(
        {"127.0.0.1", 0},
        [](const ops::HttpRequest& request) {
          Require(request.body.size() <= ops::HttpListener::kMostBodyBytes);
          return ops::HttpResponse{.body = request.method + request.target + request.authorization};
        },
        error);
    Require(ops != nullptr);
    const int probe = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    Require(bind(probe, reinterpret_cast<const sockaddr*>(&own), size) == 0);
    Require(getsockname(probe, reinterpret_cast<sockaddr*>(&own), &size) == 0);
    close(probe);
    options.port = ntohs(own.sin_port);
    options.bindAddress = "127.0.0.1";
    options.worlds.push_back({"", {"127.0.0.1", 9}});
    options.maxConnections = 1000;
    options.maxPerAddress = options.maxConnections;
    // Each WebSocket says that it is another's: an address opens only some a second.
    options.proxies = {"127.0.0.1"};
    page["/index.html"] = {.type = "text/html", .bytes = "<p>wobble</p>", .gzip = ""};
    std::freopen("/dev/null", "w", stdout);
    std::thread([this] { Require(gateway::RunGateway(options, page, [] { return false; }) == 0); }).detach();
    for (int i = 0; i < 500 && !Answers(); ++i) usleep(10000);
  }
  [[nodiscard]] bool Answers() const {
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(options.port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool isGood = connect(connection, reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0;
    close(connection);
    return isGood;
  }

  std::unique_ptr<ops::HttpListener> ops;
  gateway::GatewayOptions options;
  gateway::Page page;
};

void FuzzOne(std::span<const std::uint8_t> bytes) {
  static Servers& servers = *new Servers;
  static unsigned turns = 0;
  if (bytes.empty()) return;
  const std::string text(bytes.begin() + 1, bytes.end());
  const bool ends = bytes[0] % 2 == 0;
  switch (bytes[0] / 2 % 3) {
    case 0:
      static_cast<void>(Exchange(servers.ops->ReadPort(), text, ends));
      break;
    case 1:
      static_cast<void>(Exchange(servers.options.port, text, ends));
      break;
    default:
      static_cast<void>(Exchange(servers.options.port,
                                 "GET /play HTTP/1.1\r\nHost: h\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                 "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                                 "X-Forwarded-For: 2001:db8:0:" +
                                     std::to_string(turns % 10000) +
                                     "::1\r\nSec-WebSocket-Protocol: " + gateway::MakeSubprotocol() + "\r\n\r\n" + text,
                                 ends));
      break;
  }
  if (++turns % 64 != 0) return;
  const std::string good = "GET / HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n";
  Require(Exchange(servers.ops->ReadPort(), good, false).find("200 OK") != std::string::npos);
  Require(Exchange(servers.options.port, good, false).find("200 OK") != std::string::npos);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
