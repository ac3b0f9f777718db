// Bodies of every kind that has a shape to get back, of any size and material, each in a state that no motion can have
// brought, for two seconds. A reset does not count as a recovery: it is what is left for bodies that forces cannot
// mend.
#include <algorithm>
#include <array>
#include <optional>

#include "server/scenes/blueprint_definition.h"
#include "tests/bench/random.h"
#include "tests/bench/stability/experiments.h"
#include "tests/bench/stability/random_bodies.h"
#include "tests/bench/trials.h"
#include "tests/support/broken_states.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr std::size_t kBrokenStates = 10000;
constexpr std::size_t kBrokenStatesQuick = 200;

enum class BodyKind { kBall, kRing, kLattice, kSolid, kShell };
constexpr std::array kKindNames{"ball", "ring", "lattice", "solid", "long or flat shell"};

void VaryMaterial(Random& random, Material& material) {
  material.mass *= random.DrawMagnitude(0.5, 2);
  material.stiffness *= random.DrawMagnitude(0.5, 4);
  material.gas *= random.DrawMagnitude(0.7, 3);
  material.dampingRatio = random.Draw(0.05, 0.4);
}

BallDefinition DraftBall(Random& random) {
  BallDefinition ball;
  ball.subdivisions = random.DrawWhole(1, 3);
  ball.radius = random.Draw(0.3, 1);
  VaryMaterial(random, ball.material);
  return ball;
}

// Half of them have several layers.
RingDefinition DraftRing(Random& random) {
  RingDefinition ring;
  ring.points = random.DrawWhole(8, 48);
  ring.layers = random.Happens(0.5) ? 1 : random.DrawWhole(2, 4);
  ring.thickness = ring.radius * random.Draw(0.2, 0.6);
  VaryMaterial(random, ring.material);
  return ring;
}

// Lattices and solids have 1 to 6 cells along each axis, and are at most 1.2 m long.
template <class Definition>
Definition DraftCells(Random& random) {
  Definition body;
  for (int& cells : body.cells) cells = random.DrawWhole(1, 6);
  body.cellSize = random.Draw(0.5, 1.2) / *std::ranges::max_element(body.cells);
  body.density = random.DrawMagnitude(10, 100);
  body.youngModulus *= random.DrawMagnitude(0.5, 10);
  body.dampingRatio = random.Draw(0.05, 0.4);
  return body;
}

LatticeDefinition DraftLattice(Random& random) {
  auto lattice = DraftCells<LatticeDefinition>(random);
  if (random.Happens(0.3)) lattice.cells[1] = 0;
  lattice.poissonRatio = FindPoissonRatio(lattice.cells);
  return lattice;
}

SolidDefinition DraftSolid(Random& random) {
  auto solid = DraftCells<SolidDefinition>(random);
  solid.poissonRatio = random.Draw(0, 0.45);
  return solid;
}

MeshDefinition DraftShell(Random& random) {
  MeshDefinition shell;
  const Icosphere sphere = MakeIcosphere(random.DrawWhole(0, 2));
  const Vector3d axes = random.DrawWithin({0.2, 0.2, 0.2}, {0.6, 0.6, 0.6});
  for (const Vector3d& at : sphere.vertices) shell.vertices.push_back(at.cwiseProduct(axes));
  shell.faces = sphere.faces;
  shell.bend = random.Draw(0.1, 0.6);
  shell.material.gas = 250;
  VaryMaterial(random, shell.material);
  return shell;
}

// A body that scenes would accept, and whose gas, if it has any, carries twice its weight.
Blueprint DrawBlueprint(BodyKind kind, Random& random) {
  for (;;) {
    const auto make = [&](const auto& draft) -> std::optional<Blueprint> {
      if (!scenes::Validate(draft).empty()) return std::nullopt;
      return scenes::MakeBlueprint(draft);
    };
    const std::optional<Blueprint> body = kind == BodyKind::kBall      ? make(DraftBall(random))
                                          : kind == BodyKind::kRing    ? make(DraftRing(random))
                                          : kind == BodyKind::kLattice ? make(DraftLattice(random))
                                          : kind == BodyKind::kSolid   ? make(DraftSolid(random))
                                                                       : make(DraftShell(random));
    if (!body) continue;
    if (kind == BodyKind::kShell && body->full.gas < 2 * 9.81 * body->totalMass * body->reach) continue;
    return *body;
  }
}

struct State {
  BodyKind kind = BodyKind::kBall;
  Broken how = Broken::kFlattened;
  std::size_t vertices = 0;
  Recovery recovery;
};

State PlayOne(std::uint64_t seed, std::size_t number) {
  Random random(seed * 1000003 + number);
  State state;
  constexpr std::size_t kWays = std::size(kAllBroken);
  state.how = kAllBroken[number % kWays];
  state.kind = static_cast<BodyKind>(number / kWays % kKindNames.size());
  const Blueprint blueprint = DrawBlueprint(state.kind, random);
  state.vertices = blueprint.rest.size();
  state.recovery = PlayBroken(state.how, blueprint, random);
  return state;
}

// What became of the bodies of one kind that were broken in one way.
nlohmann::ordered_json MakeRow(BodyKind kind, Broken how, const char* word, std::span<const State> states) {
  double of = 0;
  double recovered = 0;
  double reset = 0;
  double fastest = 0;
  double still = 0;  // off by less than 0.15
  for (const State& state : states) {
    if (state.how != how || state.kind != kind) continue;
    ++of;
    recovered += state.recovery.IsWhole() ? 1 : 0;
    reset += state.recovery.reset > 0 ? 1 : 0;
    still += state.recovery.shape < 0.15 ? 1 : 0;
    fastest = std::max(fastest, state.recovery.speed);
  }
  return {{"experiment", "broken_states"},
          {"kind", kKindNames[static_cast<std::size_t>(kind)]},
          {"state", word},
          {"bodies", of},
          {"recovered", recovered},
          {"off_by_less_than_0.15", still},
          {"reset", reset},
          {"fastest_centre", fastest}};
}

}  // namespace

void MeasureBrokenStates(Bench& bench) {
  constexpr std::array kWords{"flattened", "inside out", "folded", "random places"};
  std::vector<State> states(bench.options.quick ? kBrokenStatesQuick : kBrokenStates);
  if (!RunTrials(bench, states.size(), [&](std::size_t i) { states[i] = PlayOne(bench.options.seed, i); })) return;
  for (std::size_t kind = 0; kind < kKindNames.size(); ++kind) {
    for (std::size_t how = 0; how < kWords.size(); ++how) {
      bench.results.rows.push_back(MakeRow(static_cast<BodyKind>(kind), kAllBroken[how], kWords[how], states));
    }
  }
  double whole = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    whole += states[i].recovery.IsWhole() ? 1 : 0;
    if (states[i].recovery.IsWhole()) continue;
    bench.results.rows.push_back({{"experiment", "not_recovered"},
                                  {"number", static_cast<double>(i)},
                                  {"kind", kKindNames[static_cast<std::size_t>(states[i].kind)]},
                                  {"vertices", static_cast<double>(states[i].vertices)},
                                  {"shape", states[i].recovery.shape},
                                  {"reset", static_cast<double>(states[i].recovery.reset)}});
  }
  const auto count = static_cast<double>(states.size());
  bench.results.AddFigure("broken_states", count);
  bench.results.AddFigureAtLeast("recovered_share", whole / count, 1);
}

}  // namespace wobble::bench
