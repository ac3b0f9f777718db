// Runs independent trials on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "tests/bench/report.h"

namespace wobble::bench {

// Calls run(i) for all i below count, in any order, until a stop is asked for; each call stores its result in its own
// place. Uses plain threads, because a world limits oneTBB's threads to its own number. False when a stop was asked
// for.
template <class Run>
bool RunOnAllCores(Bench& bench, std::size_t count, const Run& run) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count && !bench.progress.IsStopAsked(); i = next++) run(i);
  };
  std::vector<std::jthread> threads(std::max(1U, std::thread::hardware_concurrency()));
  for (std::jthread& thread : threads) thread = std::jthread(work);
  for (std::jthread& thread : threads) thread.join();
  return !bench.progress.IsStopAsked();
}

// As RunOnAllCores; shows how many trials are done. For trials of seconds: a stop waits for those that run.
template <class Run>
bool RunTrials(Bench& bench, std::size_t count, const Run& run) {
  std::atomic<std::size_t> done{0};
  return RunOnAllCores(bench, count, [&](std::size_t i) {
    run(i);
    bench.progress.Show(++done, count);
  });
}

}  // namespace wobble::bench
