// A hundred bodies of a kind on one another in a shaft, for three seconds, and two seconds without gravity. The lowest
// ones bear a hundred times their weight, which default materials are not made for: all are pressed into one group, and
// its ticks take up to some seconds; those of a hundred cloths, each of whose vertices meets dozens of sheets, up to a
// minute. So cloths are a part of their own, progress is shown by ticks, and a stop ends a stack within one.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "tests/bench/stress/experiments.h"
#include "tests/bench/stress/rows.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kBodies = 100;
constexpr int kBodiesQuick = 12;
constexpr int kStackTicks = 180;     // under gravity
constexpr int kReleasedTicks = 120;  // without
constexpr double kGap = 0.05;        // between bodies at first, m

struct Stack {
  StressBody body = StressBody::kBall162;
  std::uint64_t seed = 0;
  StressOutcome outcome;
};

// One of each kind but cloth; a quick run has those that step fastest.
std::vector<StressBody> ListBodies(bool quick) {
  if (quick) return {StressBody::kBall42, StressBody::kLattice};
  std::vector<StressBody> bodies(std::begin(kAllStressBodies), std::end(kAllStressBodies));
  std::erase(bodies, StressBody::kCloth);
  return bodies;
}

// Each body is aside of the shaft's middle by up to a twentieth of its reach.
std::unique_ptr<World> MakeStack(const Stack& stack, int bodies) {
  auto world = std::make_unique<World>(WorldSettings{});
  Random random(stack.seed);
  const Blueprint body = MakeStressBody(stack.body);
  world->AddBlueprint(body);
  world->AddObstacle({});
  AddShaft(1.2 * body.reach, *world);
  double low = 0;
  double high = 0;
  for (const Vector3d& at : body.rest) {
    low = std::min(low, at.z());
    high = std::max(high, at.z());
  }
  const double most = 0.05 * body.reach;
  for (int i = 0; i < bodies; ++i) {
    const double aside = body.full.planar ? 0 : random.Draw(-most, most);
    world->AddBody(0, Vector3d(random.Draw(-most, most), aside, kGap - low + i * (high - low + kGap)));
  }
  return world;
}

// afterTick: called after every tick; false ends the stack.
void PlayStack(Stack& stack, int bodies, const auto& afterTick) {
  const std::unique_ptr<World> world = MakeStack(stack, bodies);
  for (int tick = 0; tick < kStackTicks + kReleasedTicks; ++tick) {
    if (tick == kStackTicks) world->SetGravity(Vector3d::Zero());
    PlayStress(*world, world->Settings().tickDuration, stack.outcome);
    if (!afterTick()) return;
  }
  NoteInverted(*world, stack.outcome);
  for (const Body& each : world->Bodies()) stack.outcome.through += world->FindCentre(each).z() < 0 ? 1 : 0;
}

// name: of the figures, before an underscore.
void PlayStacks(Bench& bench, std::span<const StressBody> bodies, const std::string& name) {
  std::vector<Stack> stacks;
  for (const StressBody body : bodies) stacks.push_back({body, bench.options.seed * 1000003, {}});
  const std::size_t ticks = stacks.size() * (kStackTicks + kReleasedTicks);
  std::atomic<std::size_t> played{0};
  const bool done = RunOnAllCores(bench, stacks.size(), [&](std::size_t i) {
    PlayStack(stacks[i], bench.options.quick ? kBodiesQuick : kBodies, [&] {
      bench.progress.Show(++played, ticks);
      return !bench.progress.IsStopAsked();
    });
  });
  if (!done) return;
  StressOutcome whole;
  for (const Stack& stack : stacks) {
    Add(stack.outcome, whole);
    bench.results.rows.push_back(MakeStressRow("stacks", "stack", NameStressBody(stack.body), 1, stack.outcome));
  }
  bench.results.AddFigure(name, static_cast<double>(stacks.size()));
  bench.results.AddFigureAtMost(name + "_fallen_through", whole.through, 0);
  bench.results.AddFigureAtMost(name + "_non_finite", whole.nonFinite, 0);
  bench.results.AddFigureAtMost(name + "_reset", whole.reset, 0);
  bench.results.AddFigureAtMost(name + "_inverted_after_2s", whole.inverted, 0);
  bench.results.AddFigureAtMost(name + "_folded_lattices", whole.folded, 0);
  bench.results.AddFigure(name + "_quarantined", whole.quarantined);
}

}  // namespace

void MeasureStressStacks(Bench& bench) { PlayStacks(bench, ListBodies(bench.options.quick), "stacks"); }

void MeasureClothPile(Bench& bench) {
  if (bench.options.quick) return;
  constexpr StressBody kBody[] = {StressBody::kCloth};
  PlayStacks(bench, kBody, "cloth_pile");
}

}  // namespace wobble::bench
