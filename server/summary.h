// The figures of a run: tick times, the JSON that --summary writes, and the status line.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "server/server.h"

namespace wobble::server {

// A histogram of tick durations in bins of 10 µs up to 100 ms. Its memory does not grow with the length of the run.
class TickTimes {
 public:
  // budget: the longest duration that is not an overrun, s.
  explicit TickTimes(double budget) : m_budget(budget) {}
  // duration: s.
  void Record(double duration);
  // The duration that `share` (0..1) of the ticks do not exceed: the upper edge of its bin, ms; 0 before the first
  // tick.
  [[nodiscard]] double PercentileMs(double share) const;
  [[nodiscard]] double MaxMs() const { return m_max * 1000; }
  [[nodiscard]] std::uint64_t Overruns() const { return m_overruns; }

 private:
  static constexpr double kBin = 1e-5;
  double m_budget;
  std::array<std::uint64_t, 10001> m_bins{};
  std::uint64_t m_count = 0;
  std::uint64_t m_overruns = 0;
  double m_max = 0;
};

// One flat JSON object of totals and rates over the whole run. Figures per vertex are null when no vertex was sent.
[[nodiscard]] std::string MakeSummary(const Server& server, const TickTimes& times);

// One line for people, without a line end. elapsed: s.
[[nodiscard]] std::string MakeStatusLine(const Server& server, const TickTimes& times, double elapsed,
                                         std::uint64_t bytesOutLastSecond);

}  // namespace wobble::server
