// So many players on one server, each side on a core of its own, over real sockets.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/scenes/scene.h"
#include "server/training/basis_training.h"
#include "tests/bench/capacity/guests.h"
#include "tests/bench/capacity/host.h"
#include "tests/bench/capacity/shown.h"

namespace wobble::bench {

// What all parties of a report have in common.
struct Game {
  scenes::Scene scene;
  std::vector<server::Bases> bases;
  std::string script;
  std::uint64_t seed = 1;
};

// A client's share of the wire, kbit/s with all headers: what 64 moving balls take, 22 each, and some more. The players
// of this report are to be within 1,500 with what comes beside snapshots.
inline constexpr double kClientKbit = 1450;

struct Party {
  unsigned players = 0;
  std::string fault;  // empty, or why there was none, in one line; then nothing else is filled in
  Hosted hosted;
  Guested guested;
  Shown shown;
};

// isStopAsked: the party ends early, and what has been measured of it is worth nothing.
[[nodiscard]] Party PlayParty(const Game& game, unsigned players, const Timetable& timetable,
                              const std::function<bool()>& isStopAsked);

}  // namespace wobble::bench
