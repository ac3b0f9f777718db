// Balls and rings of any size and material, each in a state that no motion can have brought, for two seconds. A reset
// does not count as a recovery: it is what is left for bodies that forces cannot mend.
#include <array>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/ring.h"
#include "tests/bench/random.h"
#include "tests/bench/stability/experiments.h"
#include "tests/bench/trials.h"
#include "tests/support/broken_states.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr std::size_t kBrokenStates = 10000;
constexpr std::size_t kBrokenStatesQuick = 200;

// A body that scenes would accept; most are balls.
Blueprint DrawBody(Random& random) {
  const auto fill = [&](Material& material) {
    material.mass *= random.DrawMagnitude(0.5, 2);
    material.stiffness *= random.DrawMagnitude(0.5, 4);
    material.gas *= random.DrawMagnitude(0.7, 3);
    material.dampingRatio = random.Draw(0.05, 0.4);
  };
  for (;;) {
    if (random.Happens(0.2)) {
      RingDefinition ring;
      ring.points = random.DrawWhole(8, 48);
      fill(ring.material);
      if (ValidateRing(ring).empty()) return MakeRing(ring);
    } else {
      BallDefinition ball;
      ball.subdivisions = random.DrawWhole(1, 3);
      ball.radius = random.Draw(0.3, 1);
      fill(ball.material);
      if (ValidateBall(ball).empty()) return MakeBall(ball);
    }
  }
}

struct State {
  Broken how = Broken::kFlattened;
  std::size_t vertices = 0;
  Recovery recovery;
};

State PlayOne(std::uint64_t seed, std::size_t number) {
  Random random(seed * 1000003 + number);
  State state;
  state.how = kAllBroken[number % std::size(kAllBroken)];
  const Blueprint blueprint = DrawBody(random);
  state.vertices = blueprint.rest.size();
  state.recovery = PlayBroken(state.how, blueprint, random);
  return state;
}

}  // namespace

void MeasureBrokenStates(Bench& bench) {
  constexpr std::array kWords{"flattened", "inside out", "folded", "random places"};
  std::vector<State> states(bench.options.quick ? kBrokenStatesQuick : kBrokenStates);
  if (!RunTrials(bench, states.size(), [&](std::size_t i) { states[i] = PlayOne(bench.options.seed, i); })) return;
  double whole = 0;
  for (std::size_t how = 0; how < kWords.size(); ++how) {
    double of = 0;
    double recovered = 0;
    double reset = 0;
    double fastest = 0;
    double still = 0;  // off by less than 0.15
    for (const State& state : states) {
      if (state.how != kAllBroken[how]) continue;
      ++of;
      recovered += state.recovery.IsWhole() ? 1 : 0;
      reset += state.recovery.reset > 0 ? 1 : 0;
      still += state.recovery.shape < 0.15 ? 1 : 0;
      fastest = std::max(fastest, state.recovery.speed);
    }
    whole += recovered;
    bench.results.rows.push_back({{"experiment", "broken_states"},
                                  {"state", kWords[how]},
                                  {"bodies", of},
                                  {"recovered", recovered},
                                  {"off_by_less_than_0.15", still},
                                  {"reset", reset},
                                  {"fastest_centre", fastest}});
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i].recovery.IsWhole()) continue;
    bench.results.rows.push_back({{"experiment", "not_recovered"},
                                  {"number", static_cast<double>(i)},
                                  {"vertices", static_cast<double>(states[i].vertices)},
                                  {"shape", states[i].recovery.shape},
                                  {"reset", static_cast<double>(states[i].recovery.reset)}});
  }
  const auto count = static_cast<double>(states.size());
  bench.results.AddFigure("broken_states", count);
  bench.results.AddFigureAtLeast("recovered_share", whole / count, 1);
}

}  // namespace wobble::bench
