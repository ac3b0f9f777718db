// What page_player.mjs does, over UDP by the native client library: joins, moves, takes a frame 60 times a second, and
// prints what it saw as one line of JSON.
//
//   native_player HOST PORT SECONDS
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <thread>
#include <vector>

#include "client/client.h"
#include "protocol/transport/enet_transport.h"

using namespace wobble;

namespace {

// As page_player.mjs has them.
constexpr double kSettledAfter = 3;  // s of play after which the figures begin
constexpr double kGapFrom = 0.2;     // s without a newer snapshot
constexpr double kLowDelay = 0.12;   // s

double Now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double FindPercentile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

struct Seen {
  std::vector<double> delays, ages, gaps;
  double join = 0, lowAfter = 0;
  double leastEcho = std::numeric_limits<double>::infinity();
  std::uint64_t stalls = 0;
};

Seen Play(client::Client& client, double begin, double seconds) {
  Seen seen;
  std::uint64_t count = 0, stallsBefore = 0;
  double newestAt = begin, playingAt = 0;
  std::vector<client::BodySample> samples;
  auto frame = std::chrono::steady_clock::now();
  for (double now = begin; now < begin + seconds && client.ReadState() != client::State::kEnded; now = Now()) {
    client.Update(now);
    if (client.ReadState() == client::State::kPlaying) {
      if (playingAt == 0) playingAt = now;
      const auto turn = static_cast<float>(1.5 * (now - begin));
      client.SetInput({.moveX = std::cos(turn), .moveY = std::sin(turn)});
      client.Sample(now, client::Detail::kVertices, samples);
      const client::Statistics& figures = client.ReadStatistics();
      const double delay = client.InterpolationDelay();
      const bool isSettled = now > playingAt + kSettledAfter;
      if (figures.snapshots != count) {
        if (isSettled && now - newestAt >= kGapFrom) seen.gaps.push_back(now - newestAt);
        count = figures.snapshots;
        newestAt = now;
      }
      if (figures.inputToSnapshot > 0) seen.leastEcho = std::min(seen.leastEcho, figures.inputToSnapshot);
      if (seen.lowAfter == 0 && delay > 0 && delay <= kLowDelay) seen.lowAfter = now - begin;
      if (isSettled) {
        if (seen.delays.empty()) stallsBefore = figures.stalls;
        seen.stalls = figures.stalls - stallsBefore;
        seen.delays.push_back(delay);
        seen.ages.push_back(figures.snapshotAge);
      }
    }
    frame += std::chrono::microseconds(16'667);  // as a display does, whatever a frame takes
    std::this_thread::sleep_until(frame);
  }
  seen.join = client.ReadStatistics().joinSeconds;
  return seen;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: native_player HOST PORT SECONDS\n"), 2;
  const double seconds = std::atof(argv[3]);
  std::string error;
  auto transport = transport::EnetTransport::Connect(argv[1], static_cast<std::uint16_t>(std::atoi(argv[2])), error);
  if (transport == nullptr) return std::fprintf(stderr, "native_player: %s\n", error.c_str()), 1;
  const double begin = Now();
  client::Client client(std::move(transport), {.name = "native"}, begin);
  Seen seen = Play(client, begin, seconds);
  const bool isLost = client.ReadState() == client::State::kEnded;
  const double minutes = std::max(1.0, seconds - kSettledAfter) / 60;
  std::printf(
      "{\"join_ms\":%.1f,\"low_delay_after_ms\":%.1f,\"display_delay_ms_p50\":%.1f,\"display_delay_ms_p99\":%.1f,"
      "\"snapshot_age_ms_p50\":%.1f,\"least_input_to_snapshot_ms\":%.1f,\"stalls_per_minute\":%.1f,"
      "\"gaps_per_minute\":%.1f,\"longest_gap_ms\":%.1f,\"connections_lost\":%d}\n",
      1e3 * seen.join, 1e3 * seen.lowAfter, 1e3 * FindPercentile(seen.delays, 0.5),
      1e3 * FindPercentile(seen.delays, 0.99), 1e3 * FindPercentile(seen.ages, 0.5), 1e3 * seen.leastEcho,
      static_cast<double>(seen.stalls) / minutes, static_cast<double>(seen.gaps.size()) / minutes,
      1e3 * FindPercentile(seen.gaps, 1), isLost ? 1 : 0);
  if (isLost) std::fprintf(stderr, "native_player: %s\n", client.EndReason().c_str());
  client.Leave(Now());
  client.Update(Now());
  return seen.delays.empty() ? 1 : 0;
}
