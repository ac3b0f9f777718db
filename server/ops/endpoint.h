// Where a server is watched over HTTP: /metrics for Prometheus, /healthz and /readyz for whoever starts, replaces and
// fills servers. Answers on threads of its own: a scrape never holds up a tick for longer than it takes to copy the
// figures.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/ops/figures.h"

namespace wobble::ops {

// Seconds without a word from the tick loop after which it is taken for dead.
inline constexpr double kDeadAfter = 3;

struct Address {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;  // 0: the system picks a free one
};
// HOST:PORT, [IPv6]:PORT, or PORT alone for this machine only. False with one line in `error`.
[[nodiscard]] bool ParseAddress(const std::string& text, Address& address, std::string& error);

class Endpoint {
 public:
  // null with one line in `error` when the port cannot be had. clock: s, as Tell's figures have it, read by several
  // threads.
  [[nodiscard]] static std::unique_ptr<Endpoint> Listen(const Address& address, const std::string& version,
                                                        const std::string& scene, server::Clock clock,
                                                        std::string& error);
  ~Endpoint();

  // The TCP port that it listens on, also when the system picked it.
  [[nodiscard]] std::uint16_t ReadPort() const;

  // From the tick loop, after each tick. Until the first call /readyz and /healthz answer that it is starting.
  void Tell(const Figures& figures);

 private:
  struct Implementation;
  explicit Endpoint(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::ops
