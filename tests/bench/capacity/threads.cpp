// A tick by two threads against one, on the wall: what a host with two cores gains. Every run plays the same game, so
// that the shortest time of each tick over several runs leaves other load of the machine out, and the 99th percentile
// is then that of the game.
#include <algorithm>

#include "tests/bench/capacity/crowd.h"
#include "tests/bench/capacity/experiments.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr double kThreadsWarmUp = 2;  // s

// Wall time of each tick after the warm-up, s; the shortest so far.
class ShortestTicks {
 public:
  void Begin() { m_next = 0; }
  void Note(double seconds) {
    if (m_next == m_ticks.size()) m_ticks.push_back(seconds);
    m_ticks[m_next] = std::min(m_ticks[m_next], seconds);
    ++m_next;
  }
  [[nodiscard]] double FindMs(double share) const {
    std::vector<double> sorted = m_ticks;
    std::ranges::sort(sorted);
    return 1000 * sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }

 private:
  std::vector<double> m_ticks;
  std::size_t m_next = 0;
};

}  // namespace

void MeasureThreads(Bench& bench) {
  const Game game = MakeGame(bench.options);
  const unsigned players = bench.options.quick ? 32 : 128;
  const int runs = bench.options.quick ? 2 : 4;
  const double end = kThreadsWarmUp + (bench.options.quick ? 1 : 3);
  ShortestTicks ticks[2];
  for (int run = 0; run < runs; ++run) {
    for (int threads = 1; threads <= 2; ++threads) {
      std::string fault;
      const auto script = LoadScript(game, fault);
      if (script == nullptr) {
        bench.results.remarks.push_back("threads: " + fault);
        return;
      }
      Crowd crowd(game, {.players = players, .threads = threads}, *script);
      crowd.Play(kThreadsWarmUp);
      ShortestTicks& shortest = ticks[threads - 1];
      shortest.Begin();
      for (double now = kThreadsWarmUp; now < end; now += 0.1) {
        crowd.Play(now, [&](double seconds) { shortest.Note(seconds); });
        if (bench.progress.IsStopAsked()) return;
      }
      bench.progress.Show(static_cast<std::size_t>(2 * run + threads), static_cast<std::size_t>(2 * runs));
    }
  }
  const double ratio = ticks[1].FindMs(0.99) / ticks[0].FindMs(0.99);
  nlohmann::ordered_json row{{"experiment", "threads"}, {"players", players}, {"runs", runs}};
  for (int threads = 1; threads <= 2; ++threads) {
    const std::string key = std::to_string(threads) + "_threads_ms_";
    row[key + "p50"] = ticks[threads - 1].FindMs(0.5);
    row[key + "p99"] = ticks[threads - 1].FindMs(0.99);
  }
  bench.results.rows.push_back(std::move(row));
  bench.results.AddFigureAtMost("two_threads_ratio", ratio, 0.6, !bench.options.quick);
  bench.results.remarks.push_back(
      FormatLine("threads: a tick of %u players takes one thread %.2f, %.2f ms (p50, p99), two %.2f, %.2f", players,
                 ticks[0].FindMs(0.5), ticks[0].FindMs(0.99), ticks[1].FindMs(0.5), ticks[1].FindMs(0.99)));
}

}  // namespace wobble::bench
