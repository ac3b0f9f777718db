// A thread that makes the reconciler's calls, and the log of calls that fail.
#include "server/ops/agones.h"

#include <httplib.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <utility>

#include "server/ops/agones_messages.h"

namespace wobble::ops {
namespace {

constexpr time_t kTimeout = 1;  // s
constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kStopInterval{20};
constexpr double kLongestWait = 3600;  // s

double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
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

void Agones::Want(const FleetWish& wish) {
  const std::lock_guard lock(m_mutex);
  if (wish == m_wish) return;
  m_wish = wish;
  m_changed.notify_all();
}

Agones::Counts Agones::ReadCounts() const {
  const std::lock_guard lock(m_mutex);
  return m_counts;
}

void Agones::Work() {
  BlockSignals();
  std::unique_lock lock(m_mutex);
  while (m_stage == Stage::kRunning || m_stage == Stage::kEnding) {
    m_reconciler.Want(m_wish);
    const double began = ReadClock();
    const std::optional<FleetCall> call = m_reconciler.Next(began);
    if (call) {
      lock.unlock();
      const Outcome outcome = Send(*call);
      Log(*call, outcome.trouble, m_reconciler.Learn(*call, outcome.answer, began, ReadClock()));
      lock.lock();
      ++(outcome.trouble.empty() ? m_counts.succeeded : m_counts.failed);
      m_counts.corrections = m_reconciler.Corrections();
    } else if (m_stage == Stage::kEnding) {
      break;
    } else {
      const double wait = std::min(m_reconciler.NextTime(began) - began, kLongestWait);
      m_changed.wait_for(lock, std::chrono::duration<double>(wait));
    }
  }
  m_stage = Stage::kDone;
  m_changed.notify_all();
}

Agones::Outcome Agones::Send(const FleetCall& call) {
  const SidecarRequest request = MakeRequest(call);
  const std::string type = "application/json";
  const std::string_view method = request.method;
  const httplib::Result result = method == "GET"     ? m_client->Get(request.path)
                                 : method == "PATCH" ? m_client->Patch(request.path, request.body, type)
                                                     : m_client->Post(request.path, request.body, type);
  Outcome outcome;
  if (!result) {
    const bool isUnreached =
        result.error() == httplib::Error::Connection || result.error() == httplib::Error::ConnectionTimeout;
    outcome.trouble = isUnreached ? "no connection" : "no answer";
    return outcome;
  }
  outcome.answer = ReadAnswer(call, result->status, result->body, outcome.trouble);
  return outcome;
}

// Every change of trouble is said once: a sidecar that stays dead fills no disk.
void Agones::Log(const FleetCall& call, const std::string& trouble, const std::string& news) {
  const SidecarRequest request = MakeRequest(call);
  std::string& said = m_troubles[static_cast<std::size_t>(call.kind)];
  if (said != trouble) {
    if (trouble.empty()) {
      spdlog::info("Agones: {} {}: works again", request.method, request.path);
    } else {
      spdlog::warn("Agones: {} {}: {}", request.method, request.path, trouble);
    }
    said = trouble;
  }
  if (!news.empty()) spdlog::warn("Agones: {}", news);
}

}  // namespace wobble::ops
