// What a run was like: tick times as main measured them, and the JSON that --summary writes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "server/server.h"

namespace wobble::server {

// Durations of ticks in bins of 10 µs up to 100 ms; bounded memory however long a server runs.
class TickTimes {
 public:
  // budget: longest duration that is no overrun, s.
  explicit TickTimes(double budget) : m_budget(budget) {}
  void Record(double duration);
  [[nodiscard]] double PercentileMs(double share) const;  // upper edge of the bin; 0 before the first tick
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

// One flat JSON object with the keys of the product's specification; null for what does not exist yet.
[[nodiscard]] std::string MakeSummary(const Server& server, const TickTimes& times);

// One line for people.
[[nodiscard]] std::string MakeStatusLine(const Server& server, const TickTimes& times, double elapsed,
                                         std::uint64_t bytesOutLastSecond);

}  // namespace wobble::server
