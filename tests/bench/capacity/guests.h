// The players' half of a party: bots in a thread of their own, as `wobble bots` runs them.
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

// How long each stage of a party is, s.
struct Timetable {
  double settle = 3;  // once all have had the time to come
  double count = 20;
  double show = 2;
};

struct Guested {
  bots::Figures figures;  // times: of the stage that counts and what follows; joins and disconnects: of all
  unsigned playing = 0;   // at its end
  double work = 0;        // of the core that the bots have, the share that they took meanwhile
  std::vector<View> views;
};

class Guests {
 public:
  // script: loaded; must outlive this, as `stage` must. Whoever runs the server follows it.
  Guests(unsigned players, std::uint16_t port, std::uint64_t seed, bots::Script& script, const Timetable& timetable,
         std::atomic<Stage>& stage);

  // By the calling thread, until all have left; isStopAsked: they leave at once. Moves the party on, at the end to
  // kOver.
  void Run(const std::function<bool()>& isStopAsked);
  // After that.
  [[nodiscard]] Guested Take() { return std::move(m_guested); }

 private:
  void PlayStages(double began, const std::function<bool()>& isStopAsked);
  void Enter(Stage stage);
  void Keep(client::Client& client, std::span<const client::BodySample> shown, double now);

  Timetable m_timetable;
  double m_ramp;
  std::atomic<Stage>& m_stage;
  bots::Runner m_runner;
  std::uint64_t m_rounds = 0;  // of decoding bots, while shown
  double m_entered = 0;
  double m_enteredWork = 0;
  Guested m_guested;
};

}  // namespace wobble::bench
