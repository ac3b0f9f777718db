// Stability of stacks. Cubes lie on each other, face on face and vertex on vertex, with a gap of a finger's breadth or
// none, for 20 s or until they sleep; after that no bit may change for 10 s.
//
// A stack of equal bodies has no preferred direction, so any sideways displacement of its top is error. Static friction
// lets it move only as far as its springs yield, tenths of a millimetre; a sliding stack exceeds any limit. The slabs
// of jelly_stack have so little damping that they sway longer than the cubes, and have their own key.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kStands = 20;       // s
constexpr double kPatience = 90;     // for stacks that sleep later, s
constexpr double kAfterAsleep = 10;  // s

struct Stack {
  std::string body;
  LatticeDefinition definition;
  int count = 4;
  double gap = 0;  // m
  bool isSlab = false;
  double drift = 0;   // sideways, of the top, m
  double sunk = 0;    // of the top below its height in a rigid stack, m
  double asleep = 0;  // time until it sleeps, s; negative: it does not
  bool changed = false;
};

void PlayStack(Stack& each) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeLattice(each.definition));
  world.AddObstacle(Obstacle{});
  const double height = each.definition.cells[2] * each.definition.cellSize;
  for (int i = 0; i < each.count; ++i) {
    world.AddBody(0, Vector3d(0, 0, height / 2 + each.gap + i * (height + each.gap)));
  }
  const Body& top = world.Bodies().back();
  each.asleep = -1;
  for (int tick = 1; tick * kContactTick <= (each.asleep < 0 ? kPatience : kStands); ++tick) {
    const bool isAwake = world.Step().awake > 0;
    if (isAwake || each.asleep < 0) each.asleep = isAwake ? -1 : tick * kContactTick;
    each.drift = std::max(each.drift, world.FindCentre(top).head<2>().norm());
  }
  each.sunk = (each.count - 0.5) * height - world.FindCentre(top).z();
  const std::uint64_t hash = world.Hash();
  for (int tick = 1; tick <= std::lround(kAfterAsleep / kContactTick); ++tick) {
    world.Step();
    each.changed |= world.Hash() != hash;
  }
}

std::vector<Stack> MakeStacks() {
  std::vector<Stack> cases;
  const auto add = [&](const char* name, std::array<int, 3> cells, double cellSize, double youngModulus, double damping,
                       int count) {
    LatticeDefinition definition;
    definition.cells = cells;
    definition.cellSize = cellSize;
    definition.youngModulus = youngModulus;
    definition.dampingRatio = damping;
    for (const double gap : {0.0, 0.01}) cases.push_back({name, definition, count, gap, cells[2] != cells[0]});
  };
  add("cube of 8 cells", {2, 2, 2}, 0.25, 10000, 0.3, 4);
  add("cube of 27 cells", {3, 3, 3}, 0.5 / 3, 10000, 0.3, 4);
  add("slab of jelly_stack", {5, 5, 2}, 0.3, 31400, 0.1, 8);
  return cases;
}

}  // namespace

void MeasureStacks(Bench& bench) {
  std::vector<Stack> cases = MakeStacks();
  if (!RunTrials(bench, cases.size(), [&](std::size_t i) { PlayStack(cases[i]); })) return;
  double drift = 0;
  double asleep[2] = {0, 0};  // cubes, slabs
  bool changed = false;
  for (const Stack& each : cases) {
    constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
    drift = std::max(drift, each.drift);
    double& latest = asleep[each.isSlab ? 1 : 0];
    latest = each.asleep < 0 || std::isnan(latest) ? kNever : std::max(latest, each.asleep);
    changed |= each.changed;
    bench.results.rows.push_back({{"experiment", "stack"},
                                  {"body", each.body},
                                  {"count", each.count},
                                  {"gap", each.gap},
                                  {"drift", each.drift},
                                  {"sunk", each.sunk},
                                  {"asleep_s", each.asleep},
                                  {"changed_after", each.changed}});
  }
  bench.results.AddFigureAtMost("stack_drift", drift, 0.001);
  bench.results.AddFigureAtMost("stack_asleep_s", asleep[0], kStands);
  bench.results.AddFigureAtMost("slab_stack_asleep_s", asleep[1], kPatience);
  bench.results.AddFigureAtMost("stack_changed_asleep", changed ? 1 : 0, 0);
}

}  // namespace wobble::bench
