// Serves copies of the figures. cpp-httplib brings its own threads; the only lock is the one round the figures.
#include "server/ops/endpoint.h"

#include <fmt/format.h>
#include <httplib.h>

#include <charconv>
#include <mutex>
#include <thread>

#include "server/ops/metrics.h"

namespace wobble::ops {
namespace {

constexpr int kThreads = 2;   // two, so that a slow client leaves one for others
constexpr int kPatience = 2;  // timeout of reading a request and of writing an answer, s
constexpr std::size_t kMostRequestBytes = 1024;

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

void Answer(httplib::Response& response, bool isGood, const std::string& text) {
  response.status = isGood ? 200 : 503;
  response.set_content(text + "\n", "text/plain; charset=utf-8");
}

// The port that it is bound to; -1 when that cannot be had.
int Bind(httplib::Server& http, const Address& address) {
  if (address.port == 0) return http.bind_to_any_port(address.host);
  return http.bind_to_port(address.host, address.port) ? address.port : -1;
}

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
  int port = 0;
  server::TimeSource clock;
  httplib::Server http;
  std::thread thread;
  std::mutex mutex;
  Figures figures;  // guarded by mutex

  Figures Copy() {
    const std::lock_guard lock(mutex);
    return figures;
  }

  void TellHealth(httplib::Response& response) {
    const Figures now = Copy();
    if (now.condition == Condition::kStarting) return Answer(response, false, "starting");
    const double silent = clock() - now.told;
    if (silent > kDeadAfter) return Answer(response, false, fmt::format("no tick for {:.1f} s", silent));
    Answer(response, true, now.isPaused ? "ok, the world waits for players" : "ok");
  }

  void Serve() {
    http.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(WriteMetrics(Copy(), version, scene), "text/plain; version=0.0.4; charset=utf-8");
    });
    http.Get("/healthz", [this](const httplib::Request&, httplib::Response& response) { TellHealth(response); });
    http.Get("/readyz", [this](const httplib::Request&, httplib::Response& response) {
      const Condition condition = Copy().condition;
      Answer(response, condition == Condition::kReady, Describe(condition));
    });
    http.Get("/", [](const httplib::Request&, httplib::Response& response) {
      Answer(response, true, "/metrics\n/healthz\n/readyz");
    });
  }
};

Endpoint::Endpoint(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}

std::unique_ptr<Endpoint> Endpoint::Listen(const Address& address, const std::string& version, const std::string& scene,
                                           server::TimeSource clock, std::string& error) {
  auto made = std::make_unique<Implementation>();
  made->version = version;
  made->scene = scene;
  made->clock = std::move(clock);
  made->http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  // By default the library sets SO_REUSEPORT, which would share the port with another program.
  made->http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  made->http.set_read_timeout(kPatience);
  made->http.set_write_timeout(kPatience);
  made->http.set_keep_alive_max_count(1);
  made->http.set_payload_max_length(kMostRequestBytes);
  made->Serve();
  made->port = Bind(made->http, address);
  if (made->port < 0) {
    error = fmt::format("{}:{} (TCP): cannot be listened on; is it in use, or the address another machine's?",
                        address.host, address.port);
    return nullptr;
  }
  made->thread = std::thread([http = &made->http] { http->listen_after_bind(); });
  // The destructor's stop() has no effect on a server that does not listen yet; the thread would then never end.
  while (!made->http.is_running()) std::this_thread::yield();
  return std::unique_ptr<Endpoint>(new Endpoint(std::move(made)));
}

Endpoint::~Endpoint() {
  m->http.stop();
  m->thread.join();
}

std::uint16_t Endpoint::ReadPort() const { return static_cast<std::uint16_t>(m->port); }

void Endpoint::Tell(const Figures& figures) {
  const std::lock_guard lock(m->mutex);
  m->figures = figures;
}

}  // namespace wobble::ops
