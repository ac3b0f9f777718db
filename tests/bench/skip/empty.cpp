// A server that nobody has joined, as it is started: its world stands still, and it only listens. The scene is the one
// with the most bodies. What it does to begin with does not count.
#include <unistd.h>

#include <limits>
#include <thread>

#include "tests/bench/skip/experiments.h"
#include "tests/bench/skip/programs.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr double kBegin = 2;  // s

void Wait(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

}  // namespace

void MeasureEmpty(Bench& bench) {
  // One that the system has for short-lived clients, so seldom anybody's; a server that finds it taken ends at once.
  const int port = 40000 + getpid() % 10000;
  const Running server(
      {FindProgram("wobbled"), "--scene", "crowd", "--port", std::to_string(port), "--log-level", "off"});
  Wait(kBegin);
  const double began = ReadWallTime();
  const double before = server.ReadProcessTime();
  Wait(bench.options.quick ? 2 : 20);
  const double share = (server.ReadProcessTime() - before) / (ReadWallTime() - began);
  bench.results.rows.push_back({{"experiment", "empty"}, {"scene", "crowd"}, {"cpu", share}});
  bench.results.AddFigureAtMost("empty_cpu", share, 0.005);
}

}  // namespace wobble::bench
