// The figures for one player count.
#pragma once

#include <optional>
#include <string>

#include "tests/bench/capacity/party.h"
#include "tests/bench/results.h"

namespace wobble::bench {

inline constexpr double kTickBudgetMs = 1000 * kTickSeconds;

struct Measured {
  unsigned players = 0;
  // Thread time of the server, ms.
  double tickMsP50 = 0;
  double tickMsP99 = 0;
  double tickMsP999 = 0;
  double tickMsMax = 0;
  double overrunShare = 0;  // share of ticks above the budget
  // The same in wall time, which includes other load on the core.
  double wallMsP99 = 0;
  double wallOverrunShare = 0;
  double kbit = 0;  // to each player, kbit/s, all headers included
  double shownError = 0;
  bool holds = false;          // result of Judge
  nlohmann::ordered_json row;  // all figures
  std::string line;            // a summary for people
};

[[nodiscard]] Measured Measure(const Party& party);

}  // namespace wobble::bench
