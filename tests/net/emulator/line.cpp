#include "tests/net/emulator/line.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>

namespace wobble::emulator {
namespace {

constexpr double kPatience = 0.02;  // s
constexpr std::size_t kMostBytes = 65536;

double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Line::Line(const transport::LinkSpec& spec, std::uint64_t seed, int server, int client)
    : m_ways{Way{.from = client,
                 .to = server,
                 .conditions = spec.up,
                 .direction = transport::LinkDirection(transport::MakeLinkSeeds(seed, 0).toServer)},
             Way{.from = server,
                 .to = client,
                 .conditions = spec.down,
                 .direction = transport::LinkDirection(transport::MakeLinkSeeds(seed, 0).toClient)}} {}

void Line::Run(const std::atomic<bool>& isOver) {
  const double begin = ReadClock();
  std::array<pollfd, 2> devices{pollfd{m_ways[0].from, POLLIN, 0}, pollfd{m_ways[1].from, POLLIN, 0}};
  while (!isOver) {
    const double wait = std::clamp(FindNextDue() - (ReadClock() - begin), 0.0, kPatience);
    const timespec patience{.tv_sec = 0, .tv_nsec = static_cast<long>(1e9 * wait)};
    ppoll(devices.data(), devices.size(), &patience, nullptr);
    const double now = ReadClock() - begin;
    for (Way& way : m_ways) TakeIn(way, now);
    for (Way& way : m_ways) GiveOut(way, now);
  }
}

void Line::TakeIn(Way& way, double now) {
  std::vector<std::uint8_t> bytes(kMostBytes);
  for (;;) {
    const ssize_t size = read(way.from, bytes.data(), bytes.size());
    if (size <= 0) return;
    // A link's sizes are those of UDP's payload.
    const auto payload = static_cast<std::size_t>(std::max(0.0, static_cast<double>(size) - transport::kHeaderBytes));
    const transport::Fate fate = way.direction.Decide(way.conditions, now, payload);
    if (fate.ending != transport::Fate::Ending::kPasses) ++way.counts.lost;
    for (std::size_t i = 0; i < fate.copies; ++i)
      way.waiting.push({.due = fate.due[i], .number = ++m_number, .bytes = {bytes.begin(), bytes.begin() + size}});
  }
}

void Line::GiveOut(Way& way, double now) {
  for (; !way.waiting.empty() && way.waiting.top().due <= now; way.waiting.pop()) {
    const std::vector<std::uint8_t>& bytes = way.waiting.top().bytes;
    // What the other end's device has no room for is lost, as on a network.
    if (write(way.to, bytes.data(), bytes.size()) < 0) {
      ++way.counts.lost;
      continue;
    }
    ++way.counts.passed;
    way.counts.bytes += bytes.size();
  }
}

double Line::FindNextDue() const {
  double next = std::numeric_limits<double>::infinity();
  for (const Way& way : m_ways) {
    if (!way.waiting.empty()) next = std::min(next, way.waiting.top().due);
  }
  return next;
}

}  // namespace wobble::emulator
