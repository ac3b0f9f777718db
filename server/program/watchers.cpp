#include "server/program/watchers.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>

namespace wobble::server {

StatusLine::StatusLine(double every) : m_every(every), m_isTerminal(isatty(STDOUT_FILENO) == 1) {}

void StatusLine::Update(const Server& server, const TickTimes& times, double now) {
  if (m_every <= 0 || now < m_next) return;
  m_next = now + m_every;
  const std::uint64_t bytes = server.ReadTransport().bytesOut;
  const auto rate = static_cast<std::uint64_t>(static_cast<double>(bytes - m_lastBytes) / m_every);
  m_lastBytes = bytes;
  const std::string line = MakeStatusLine(server, times, now, rate);
  fmt::print("{}{}{}", m_isTerminal ? "\r\x1b[K" : "", line, m_isTerminal ? "" : "\n");
  std::fflush(stdout);
}

void StatusLine::Finish() const {
  if (m_every > 0 && m_isTerminal) fmt::print("\n");
}

Watchers::Watchers(const Options& options)
    : times(1.0 / options.config.tickHz), status(options.statusEvery), gauge(options.config) {}

void Watchers::Watch(const Server& server, double now) {
  notices.TellAlive(now);
  WatchFiles(server);
  for (const PhaseTimes& tick : server.LastTicks()) times.Record(tick.Sum());
  refusals.Follow(server.ReadTransport(), now);
  if (teller) teller->Update(server, now);
  if (trace) trace->Write(server.LastTicks(), server.ShownTick());
  if (endpoint != nullptr) {
    gauge.Read(server, now);
    endpoint->Tell(gauge.ReadFigures());
  }
  if (agones) {
    server.ListPlaying(playing);
    agones->Want(duty.Follow({.now = now,
                              .acceptsJoins = server.AcceptsJoins(),
                              .isMatchOver = server.IsMatchOver(),
                              .isClosing = server.IsClosing(),
                              .players = playing}));
  }
  status.Update(server, times, now);
}

void Watchers::WatchFiles(const Server& server) {
  if (const recording::Recorder* recorder = server.ReadRecorder()) {
    const std::uint64_t failures = recorder->Counts().failures;
    if (failures > recordingFailures) spdlog::warn("--record: {}; tried again every 10 s", recorder->Error());
    recordingFailures = failures;
  }
  if (const recording::Checkpoints* checkpoints = server.ReadCheckpoints()) {
    const std::uint64_t failures = checkpoints->Failures();
    if (failures > 0 && stateFailures == 0)
      spdlog::error("--state: {}; tried again every second", checkpoints->Error());
    stateFailures = failures;
  }
}

}  // namespace wobble::server
