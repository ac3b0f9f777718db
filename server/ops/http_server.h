// Answers GET requests with short texts, one on each connection.
//
// Whoever can reach the port may open many connections and be slow on each. So a request has one deadline, from the
// first moment to its last byte, and connections are few: where there is no room for another the oldest ends, of the
// same address if that has its share. An honest request takes milliseconds and is never the oldest for long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/server.h"

namespace wobble::ops {

// Seconds from the acceptance of a connection to the last byte of its request; from there until the answer is taken;
// from there until the other end closes.
inline constexpr double kRequestTime = 2;
inline constexpr double kAnswerTime = 2;
inline constexpr double kLingerTime = 0.5;
// Connections at once, and those of one IPv4 address or one /64 of IPv6.
inline constexpr std::size_t kMostConnections = 32;
inline constexpr std::size_t kMostOfAnAddress = 8;
// Of a request up to the empty line; a body is not read.
inline constexpr std::size_t kMostRequestBytes = 4096;

struct Answer {
  int status = 200;  // 200, 404 or 503
  std::string text;
  std::string_view type = "text/plain; charset=utf-8";  // for Content-Type; lives as long as the program
};

class HttpServer {
 public:
  // path: of the request, without its query. It is called on the server's thread.
  using Responder = std::function<Answer(std::string_view path)>;

  // Listens at a numeric address or a name of this machine; port 0: the system picks a free one. clock: s, called on
  // the server's thread. Null with one line in `error` when that fails.
  [[nodiscard]] static std::unique_ptr<HttpServer> Listen(const std::string& host, std::uint16_t port,
                                                          Responder responder, server::TimeSource clock,
                                                          std::string& error);
  // Closes all connections and joins the thread.
  ~HttpServer();

  [[nodiscard]] std::uint16_t ReadPort() const;

 private:
  struct Implementation;
  explicit HttpServer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::ops
