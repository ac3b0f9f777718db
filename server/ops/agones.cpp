// A queue, a thread that empties it, and the rules for calls that fail.
//
// Names and paths are those of Agones' sdk.proto and beta.proto as its gateway maps them to HTTP. 64-bit numbers are
// strings there, as everywhere in the JSON of Protocol Buffers.
#include "server/ops/agones.h"

#include <httplib.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <charconv>
#include <chrono>
#include <utility>

namespace wobble::ops {
namespace {

constexpr time_t kTimeout = 1;  // s
constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kStopInterval{20};
// Two requests for each player who joins or leaves.
constexpr std::size_t kMostWaiting = 1024;

// Whether the call sets the server's state in the fleet. Such a call may be repeated without harm, and if it is lost
// the fleet's view of the server stays wrong.
bool SetsState(FleetCall::Kind kind) {
  return kind == FleetCall::Kind::kReady || kind == FleetCall::Kind::kAllocate || kind == FleetCall::Kind::kShutdown;
}

// Leaves signals to the main thread, and keeps SIGPIPE of a sidecar that hangs up from ending the server.
void BlockSignals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

std::optional<std::uint16_t> ParseSidecarPort(const std::string& text, std::string& error) {
  std::uint16_t port = 0;
  const char* const last = text.data() + text.size();
  const auto [end, result] = std::from_chars(text.data(), last, port);
  if (result == std::errc{} && end == last && port != 0) return port;
  error = "AGONES_SDK_HTTP_PORT " + text + ": must be 1 to 65535";
  return std::nullopt;
}

// The address is numeric: resolving a name can take longer than the timeouts here.
Agones::Agones(std::uint16_t port) : m_client(std::make_unique<httplib::Client>("127.0.0.1", port)) {
  m_client->set_connection_timeout(kTimeout);
  m_client->set_read_timeout(kTimeout);
  m_client->set_write_timeout(kTimeout);
  m_client->set_tcp_nodelay(true);  // the head and the body are two packets
  m_thread = std::thread(&Agones::Work, this);
}

Agones::~Agones() {
  std::unique_lock lock(m_mutex);
  m_stage = Stage::kEnding;
  m_changed.notify_all();
  const auto isDone = [this] { return m_stage == Stage::kDone; };
  if (!m_changed.wait_for(lock, kPatience, isDone)) {
    m_stage = Stage::kBrokenOff;
    // Repeated, because a request that has just begun has no connection yet that could be stopped.
    do {
      m_client->stop();
    } while (!m_changed.wait_for(lock, kStopInterval, isDone));
  }
  lock.unlock();
  m_thread.join();
}

void Agones::Perform(std::span<const FleetCall> calls) {
  if (calls.empty()) return;
  const std::lock_guard lock(m_mutex);
  for (const FleetCall& call : calls) Queue(call);
  m_isHeld = false;
  m_changed.notify_all();
}

Agones::Counts Agones::ReadCounts() const {
  const std::lock_guard lock(m_mutex);
  return m_counts;
}

void Agones::Queue(const FleetCall& call) {
  using Kind = FleetCall::Kind;
  static const std::string counter = std::string("/v1beta1/counters/") + kPlayersName;
  static const std::string list = std::string("/v1beta1/lists/") + kPlayersName;
  const std::string value = R"({"value":"player-)" + std::to_string(call.client) + R"("})";
  switch (call.kind) {
    case Kind::kHealth:
      m_isHealthDue = true;
      break;
    case Kind::kReady:
      Add({.kind = call.kind, .path = "/ready"});
      break;
    case Kind::kAllocate:
      Add({.kind = call.kind, .path = "/allocate"});
      break;
    case Kind::kAddPlayer:
      Add({.kind = call.kind, .method = "PATCH", .path = counter, .body = R"({"countDiff":"1"})"});
      Add({.kind = call.kind, .path = list + ":addValue", .body = value});
      break;
    case Kind::kRemovePlayer:
      Add({.kind = call.kind, .method = "PATCH", .path = counter, .body = R"({"countDiff":"-1"})"});
      Add({.kind = call.kind, .path = list + ":removeValue", .body = value});
      break;
    case Kind::kShutdown:
      Add({.kind = call.kind, .path = "/shutdown"});
      break;
  }
}

void Agones::Add(Request request) {
  if (m_waiting.size() >= kMostWaiting && !SetsState(request.kind)) {
    ++m_counts.dropped;
  } else {
    m_waiting.push_back(std::move(request));
  }
}

void Agones::Work() {
  BlockSignals();
  std::unique_lock lock(m_mutex);
  for (;;) {
    m_changed.wait(lock, [this] { return m_stage != Stage::kRunning || HasNext(); });
    if (m_stage == Stage::kBrokenOff || !HasNext()) break;
    Request request = TakeNext();
    lock.unlock();
    const Outcome outcome = Send(request);
    lock.lock();
    Note(std::move(request), outcome);
  }
  m_stage = Stage::kDone;
  m_changed.notify_all();
}

bool Agones::HasNext() const { return m_isHealthDue || (!m_isHeld && !m_waiting.empty()); }

Agones::Request Agones::TakeNext() {
  if (std::exchange(m_isHealthDue, false)) return {.kind = FleetCall::Kind::kHealth, .path = "/health"};
  Request request = std::move(m_waiting.front());
  m_waiting.pop_front();
  return request;
}

Agones::Outcome Agones::Send(const Request& request) {
  const std::string type = "application/json";
  const httplib::Result result = request.method == std::string_view("PATCH")
                                     ? m_client->Patch(request.path, request.body, type)
                                     : m_client->Post(request.path, request.body, type);
  if (!result) {
    const bool isConnected =
        result.error() != httplib::Error::Connection && result.error() != httplib::Error::ConnectionTimeout;
    return {.isConnected = isConnected, .trouble = isConnected ? "no answer" : "no connection"};
  }
  const bool isSuccess = result->status >= 200 && result->status < 300;
  return {.isConnected = true,
          .status = result->status,
          .trouble = isSuccess ? "" : "answered with status " + std::to_string(result->status)};
}

void Agones::Note(Request request, const Outcome& outcome) {
  if (outcome.trouble.empty()) {
    ++m_counts.succeeded;
    if (std::exchange(m_isFailing, false)) spdlog::info("Agones: {} {}: succeeded", request.method, request.path);
    return;
  }
  ++m_counts.failed;
  if (!std::exchange(m_isFailing, true)) {
    spdlog::warn("Agones: {} {}: {}; not said again until a call succeeds", request.method, request.path,
                 outcome.trouble);
  }
  if (request.kind == FleetCall::Kind::kHealth) return;
  const bool isUnheard = outcome.status == 0 || outcome.status >= 500;
  if (outcome.isConnected && !(SetsState(request.kind) && isUnheard)) return;
  m_waiting.push_front(std::move(request));
  m_isHeld = true;
}

}  // namespace wobble::ops
