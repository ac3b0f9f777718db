// Each turn runs the relay, then waits for a datagram or for the next one that is due. While there is more to do it
// does not wait, and the clock is read for each turn, so a datagram is late by a turn at most. No turn begins sooner
// than kShortestTurn after the one before: with 500 players a datagram is due every 20 us, and waking for each costs
// half as much again as sending ten at a time.
#include "client/link/relay_loop.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "client/command/clock.h"

namespace wobble::link {
namespace {

constexpr double kLongestWait = 0.05;     // seconds between calls of isDone
constexpr double kShortestTurn = 0.0002;  // seconds; adds at most this to a datagram's lateness

std::string DescribeDirection(const transport::RelayDirectionCounts& counts) {
  const auto show = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  char text[256];
  std::snprintf(text, sizeof text,
                "%llu received, %llu passed, %llu lost, %llu duplicated, %llu reordered, %llu over rate, "
                "%llu blacked out, %llu unsent",
                show(counts.received), show(counts.passed), show(counts.lost), show(counts.duplicated),
                show(counts.reordered), show(counts.overRate), show(counts.blackedOut), show(counts.unsent));
  return text;
}

}  // namespace

void RunRelay(transport::Relay& relay, const std::function<bool(double now)>& isDone) {
  const double begin = command::ReadClock();
  for (;;) {
    const double now = command::ReadClock();
    const bool isIdle = relay.Run(now);
    if (isDone(now - begin)) return;
    if (!isIdle) continue;
    relay.Wait(std::min(kLongestWait, relay.NextDue() - command::ReadClock()));
    const double early = now + kShortestTurn - command::ReadClock();
    if (early > 0) std::this_thread::sleep_for(std::chrono::duration<double>(early));
  }
}

std::string DescribeCounts(const transport::RelayCounts& counts, const std::string& prefix) {
  char players[128];
  std::snprintf(players, sizeof players, "players: %llu, %llu datagrams of too many, all left %.1f ms late (p99)\n",
                static_cast<unsigned long long>(counts.clientsEver),
                static_cast<unsigned long long>(counts.clientsRefused), counts.lateness.FindPercentileMs(0.99));
  return prefix + "up: " + DescribeDirection(counts.up) + "\n" + prefix + "down: " + DescribeDirection(counts.down) +
         "\n" + prefix + players;
}

RelayThread::RelayThread(std::unique_ptr<transport::Relay> relay)
    : m_relay(std::move(relay)),
      m_port(m_relay->ReadPort()),
      m_thread([this] { RunRelay(*m_relay, [this](double) { return m_stop.load(std::memory_order_relaxed); }); }) {}

RelayThread::~RelayThread() { Stop(); }

const transport::RelayCounts& RelayThread::Stop() {
  m_stop = true;
  if (m_thread.joinable()) m_thread.join();
  return m_relay->ReadCounts();
}

}  // namespace wobble::link
