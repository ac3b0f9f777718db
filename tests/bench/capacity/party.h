// Plays one server with a given number of players over real sockets, each side on its own core.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/bots/script.h"
#include "server/scenes/loader.h"
#include "server/training/basis_training.h"
#include "tests/bench/capacity/guests.h"
#include "tests/bench/capacity/host.h"
#include "tests/bench/capacity/shown.h"
#include "tests/bench/report.h"

namespace wobble::bench {

// What all parties of a report share.
struct Game {
  scenes::Scene scene;
  std::vector<server::Bases> bases;
  std::string script;
  std::uint64_t seed = 1;
  scenes::SceneSource source;
  std::string recordings;  // folder of the worst ten seconds; empty: they are not kept
};

// The game that the report's options name.
[[nodiscard]] Game MakeGame(const Options& options);

// The game's script, loaded, whose messages nobody reads. On failure null, with one line in `fault`.
[[nodiscard]] std::unique_ptr<bots::Script> LoadScript(const Game& game, std::string& fault);

// Budget of a client, kbit/s with all headers: 64 moving balls at 22 kbit/s each, plus a margin. Together with the
// traffic besides snapshots, players stay below 1,500 kbit/s.
inline constexpr double kClientKbit = 1450;

struct Party {
  unsigned players = 0;
  std::string fault;  // empty, or in one line why the party failed; then the other members are unset
  Hosted hosted;
  Guested guested;
  Shown shown;
  std::string recording;  // file of the worst ten seconds, or why there is none; empty: it was not asked for
};

// isStopAsked: ends the party early; its measurements are then invalid.
[[nodiscard]] Party PlayParty(const Game& game, unsigned players, const Timetable& timetable,
                              const std::function<bool()>& isStopAsked);

}  // namespace wobble::bench
