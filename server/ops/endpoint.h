// The HTTP endpoint of a server: /metrics for Prometheus, /healthz and /readyz for orchestrators and load balancers. It
// answers on a thread of its own: a scrape delays a tick by at most the time that it takes to copy the figures.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/ops/figures.h"
#include "server/ops/http_listener.h"

namespace wobble::ops {

// Time without a call of Tell after which /healthz reports the tick loop as dead, s.
inline constexpr double kDeadAfter = 3;

class Endpoint {
 public:
  // Listens on the address. Returns null with one line in `error` when that fails. version, scene: shown as labels.
  // clock: the one of Figures::told, s; called from another thread.
  [[nodiscard]] static std::unique_ptr<Endpoint> Listen(const Address& address, const std::string& version,
                                                        const std::string& scene, server::TimeSource clock,
                                                        std::string& error);
  // Stops listening and joins the thread.
  ~Endpoint();

  // The TCP port on which it listens, whether given or picked by the system.
  [[nodiscard]] std::uint16_t ReadPort() const;

  // Publishes figures. Call it from the tick loop; until the first call /readyz and /healthz answer "starting".
  void Tell(const Figures& figures);

 private:
  struct Implementation;
  explicit Endpoint(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::ops
