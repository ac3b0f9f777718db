// Serves copies of the figures; the only lock is the one round them.
#include "server/ops/endpoint.h"

#include <fmt/format.h>

#include <mutex>

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

HttpResponse Answer(bool isGood, const std::string& text) {
  return {.status = isGood ? 200U : 503U, .body = text + "\n"};
}

}  // namespace

struct Endpoint::Implementation {
  std::string version;
  std::string scene;
  server::TimeSource clock;
  std::mutex mutex;
  Figures figures;                         // guarded by mutex
  std::unique_ptr<HttpListener> listener;  // last: its thread uses what stands above

  Figures Copy() {
    const std::lock_guard lock(mutex);
    return figures;
  }

  HttpResponse TellHealth() {
    const Figures now = Copy();
    if (now.condition == Condition::kStarting) return Answer(false, "starting");
    const double silent = clock() - now.told;
    if (silent > kDeadAfter) return Answer(false, fmt::format("no tick for {:.1f} s", silent));
    return Answer(true, now.isPaused ? "ok, the world waits for players" : "ok");
  }

  HttpResponse Serve(const HttpRequest& request) {
    if (request.method != "GET" && request.method != "HEAD") return {.status = 405, .body = "only GET is answered\n"};
    const std::string path = request.target.substr(0, request.target.find('?'));
    if (path == "/metrics") {
      const Figures now = Copy();
      return {.body = WriteMetrics(now, version, now.scene.empty() ? scene : now.scene),
              .type = "text/plain; version=0.0.4; charset=utf-8"};
    }
    if (path == "/healthz") return TellHealth();
    if (path == "/readyz") {
      const Condition condition = Copy().condition;
      return Answer(condition == Condition::kReady, Describe(condition));
    }
    if (path == "/") return Answer(true, "/metrics\n/healthz\n/readyz");
    return {.status = 404, .body = "not here; see /\n"};
  }
};

Endpoint::Endpoint(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}
Endpoint::~Endpoint() = default;

std::unique_ptr<Endpoint> Endpoint::Listen(const Address& address, const std::string& version, const std::string& scene,
                                           server::TimeSource clock, std::string& error) {
  auto made = std::make_unique<Implementation>();
  made->version = version;
  made->scene = scene;
  made->clock = std::move(clock);
  made->listener = HttpListener::Listen(
      address, [serving = made.get()](const HttpRequest& request) { return serving->Serve(request); }, error);
  return made->listener == nullptr ? nullptr : std::unique_ptr<Endpoint>(new Endpoint(std::move(made)));
}

std::uint16_t Endpoint::ReadPort() const { return m->listener->ReadPort(); }

void Endpoint::Tell(const Figures& figures) {
  const std::lock_guard lock(m->mutex);
  m->figures = figures;
}

}  // namespace wobble::ops
