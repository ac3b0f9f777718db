// What is said of a count of players.
#pragma once

#include <optional>
#include <string>

#include "tests/bench/capacity/party.h"
#include "tests/bench/results.h"

namespace wobble::bench {

inline constexpr double kTickBudgetMs = 1000 * kTickSeconds;

struct Measured {
  unsigned players = 0;
  // Of the server's thread, ms.
  double tickMsP50 = 0;
  double tickMsP99 = 0;
  double tickMsP999 = 0;
  double tickMsMax = 0;
  double overrunShare = 0;  // of ticks that took more than the budget
  // The same on the wall: with what others did on its core meanwhile.
  double wallMsP99 = 0;
  double wallOverrunShare = 0;
  double kbit = 0;  // to each player, a second, all headers counted
  double shownError = 0;
  bool holds = false;          // see Judge
  nlohmann::ordered_json row;  // all of that and more
  std::string line;            // the same for people
};

[[nodiscard]] Measured Measure(const Party& party);

}  // namespace wobble::bench
