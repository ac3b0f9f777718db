// The clients of a party: bots in one thread, as `wobble bots` runs them.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "client/bots/runner.h"
#include "tests/bench/capacity/host.h"
#include "tests/bench/capacity/shown.h"

namespace wobble::bench {

// Duration of each stage of a party, s.
struct Timetable {
  double settle = 3;  // after all players have had time to join
  double count = 20;
  double show = 2;
};

struct Guested {
  bots::Figures figures;  // times: from stage kCount on; joins and disconnects: of the whole party
  unsigned playing = 0;   // at the end
  double work = 0;        // share of their core that the bots used in stage kCount
  std::vector<View> views;
};

class Guests {
 public:
  // script: a loaded script; `script` and `stage` must outlive this object. The server's thread reads `stage`.
  Guests(unsigned players, std::uint16_t port, std::uint64_t seed, bots::Script& script, const Timetable& timetable,
         std::atomic<Stage>& stage);

  // Runs the bots in the calling thread until all have left, and advances `stage`, finally to kOver. isStopAsked: they
  // leave at once.
  void Run(const std::function<bool()>& isStopAsked);
  // The result; call it after Run.
  [[nodiscard]] Guested Take() { return std::move(m_guested); }

 private:
  void PlayStages(double began, const std::function<bool()>& isStopAsked);
  void Enter(Stage stage);
  void Keep(client::Client& client, std::span<const client::BodySample> shown, double now);

  Timetable m_timetable;
  double m_ramp;
  std::atomic<Stage>& m_stage;
  bots::Runner m_runner;
  std::uint64_t m_rounds = 0;  // of decoding bots, in stage kShow
  double m_entered = 0;
  double m_enteredWork = 0;
  Guested m_guested;
};

}  // namespace wobble::bench
