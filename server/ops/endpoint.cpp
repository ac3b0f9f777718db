// Serves copies of the figures; the only lock is the one round them.
#include "server/ops/endpoint.h"

#include <fmt/format.h>

#include <charconv>
#include <mutex>

#include "server/ops/http_server.h"
#include "server/ops/metrics.h"

namespace wobble::ops {
namespace {

const char* Describe(Condition condition) {
  switch (condition) {
    case Condition::kStarting:
      return "starting";
    case Condition::kReady:
      return "ready";
    case Condition::kFull:
      return "full";
    case Condition::kBusy:
      return "busy";
    case Condition::kClosing:
      return "closing";
  }
  return "unknown";
}

Answer Say(bool isGood, const std::string& text) { return {isGood ? 200 : 503, text + "\n"}; }

}  // namespace

bool ParseAddress(const std::string& text, Address& address, std::string& error) {
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  std::string host = colon == std::string::npos ? address.host : text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  std::uint16_t port = 0;
  const auto [end, result] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (result != std::errc{} || end != digits.data() + digits.size() || host.empty()) {
    error = "'" + text + "': must be HOST:PORT or PORT, with a PORT of 0 to 65535";
    return false;
  }
  address = {host, port};
  return true;
}

struct Endpoint::Implementation {
  std::string version;
  std::string scene;
  server::TimeSource clock;
  std::mutex mutex = {};
  Figures figures = {};                        // guarded by mutex
  std::unique_ptr<HttpServer> http = nullptr;  // last: its thread uses the others

  Figures Copy() {
    const std::lock_guard lock(mutex);
    return figures;
  }

  Answer TellHealth() {
    const Figures now = Copy();
    if (now.condition == Condition::kStarting) return Say(false, "starting");
    const double silent = clock() - now.told;
    if (silent > kDeadAfter) return Say(false, fmt::format("no tick for {:.1f} s", silent));
    return Say(true, now.isPaused ? "ok, the world waits for players" : "ok");
  }

  Answer Respond(std::string_view path) {
    if (path == "/metrics") {
      return {200, WriteMetrics(Copy(), version, scene), "text/plain; version=0.0.4; charset=utf-8"};
    }
    if (path == "/healthz") return TellHealth();
    if (path == "/readyz") {
      const Condition condition = Copy().condition;
      return Say(condition == Condition::kReady, Describe(condition));
    }
    if (path == "/") return Say(true, "/metrics\n/healthz\n/readyz");
    return {404, "there is no such thing here\n"};
  }
};

Endpoint::Endpoint(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}

std::unique_ptr<Endpoint> Endpoint::Listen(const Address& address, const std::string& version, const std::string& scene,
                                           server::TimeSource clock, std::string& error) {
  std::unique_ptr<Implementation> made(new Implementation{version, scene, clock});
  made->http = HttpServer::Listen(
      address.host, address.port, [endpoint = made.get()](std::string_view path) { return endpoint->Respond(path); },
      std::move(clock), error);
  if (made->http == nullptr) return nullptr;
  return std::unique_ptr<Endpoint>(new Endpoint(std::move(made)));
}

Endpoint::~Endpoint() = default;

std::uint16_t Endpoint::ReadPort() const { return m->http->ReadPort(); }

void Endpoint::Tell(const Figures& figures) {
  const std::lock_guard lock(m->mutex);
  m->figures = figures;
}

}  // namespace wobble::ops
