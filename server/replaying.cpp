#include "server/replaying.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "server/recording/verify.h"

namespace wobble::server {

int VerifyRecording(const Options& options, const std::function<bool()>& isStopAsked) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const bool isTerminal = isatty(STDERR_FILENO) == 1;
  const auto progress = [&](double time, double end) {
    const double spent = std::chrono::duration<double>(Clock::now() - begin).count();
    if (isTerminal) fmt::print(stderr, "\r\x1b[K{:.0f} of {:.0f} s, {:.0f} times as fast", time, end, time / spent);
    return !isStopAsked();
  };
  const recording::Proof proof = recording::Verify(options.replayFile, {.threads = options.config.threads}, progress);
  if (isTerminal) fmt::print(stderr, "\r\x1b[K");
  switch (proof.verdict) {
    case recording::Verdict::kIdentical:
      fmt::print("{}\n", proof.words);
      return 0;
    case recording::Verdict::kDifferent:
      fmt::print("{}\n", proof.words);
      return 1;
    case recording::Verdict::kUnreadable:
      fmt::print(stderr, "wobbled: {}\n", proof.words);
      return 2;
  }
  return 2;
}

}  // namespace wobble::server
