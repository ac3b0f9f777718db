// The order of RK4 through contacts that press all the time: a cube pressed on the ground, and a cube pressed on
// another, under twenty times their weight, which vibrate while their contacts stick. Played by the engine in double
// precision, a quarter of a second, in 16 to 128 substeps a tick, against 512.
//
// So that nothing but the order is measured, contacts must neither begin nor end nor slip, and no depth may cross δ,
// where the law changes from a square to a line: a row says how many contacts did so on the ground.
//
// What is left of the order where contacts do begin, slip and end: the bounce and the slide of contact_scenes.h, each
// with friction and without. While a contact slips its anchor is dragged once a substep, so with friction the order is
// 1; without, the kinks of the law at the surface and at δ are all that is in the way.
#include <algorithm>
#include <cmath>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/precision_in_contact/contact_scenes.h"
#include "tests/bench/precision_in_contact/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kReferenceSubsteps = 512;
constexpr int kSettleTicks = 240;
constexpr int kSettleSubsteps = 32;
constexpr int kVibrateTicks = 15;
constexpr double kPressing = 200;  // m/s², downward
constexpr double kAnyError = 1e9;  // m/s
constexpr double kShake = 0.1;     // m/s
constexpr std::array<int, 4> kSubsteps{16, 32, 64, 128};
constexpr std::array<int, 4> kThroughSubsteps{8, 16, 32, 64};

struct PressedCase {
  const char* name;
  const char* key;
  int cubes;
  double friction;
  std::unique_ptr<World> world = nullptr;  // at rest, pressed
  std::vector<Vector3d> reference{};
  std::array<double, kSubsteps.size()> errors{};  // m
  std::size_t contacts = 0;                       // with the ground
  std::size_t changed = 0;                        // of them
};

WorldSettings MakePressing(int substeps) {
  WorldSettings settings;
  settings.precision = Precision::kDouble;
  settings.gravity = Vector3d(0, 0, -kPressing);
  settings.errorTarget = kAnyError;
  settings.leastSubsteps = substeps;
  return settings;
}

void Press(PressedCase& pressed) {
  LatticeDefinition cube = DescribeCube(40000, pressed.friction);
  cube.cells = {2, 2, 2};
  cube.cellSize = 0.2;
  cube.dampingRatio = 0.05;
  cube.rollingResistance = 0;
  pressed.world = std::make_unique<World>(MakePressing(kSettleSubsteps));
  pressed.world->AddBlueprint(MakeLattice(cube));
  pressed.world->AddObstacle(Obstacle{});
  for (int i = 0; i < pressed.cubes; ++i) {
    pressed.world->AddBody(0, Vector3d(0.06 * i, 0.05 * i, 0.2 + 0.402 * i));
  }
  for (int tick = 0; tick < kSettleTicks; ++tick) (void)pressed.world->Step();
  // A jolt that makes every vertex vibrate, more the higher it is: the lowest are held by the ground.
  for (const Body& body : pressed.world->Bodies()) {
    const std::vector<Vector3d> x = ReadPositions(body);
    std::vector<Vector3d> v;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto phase = static_cast<double>(i);
      v.emplace_back(kShake * Vector3d(std::sin(phase), std::sin(1.7 * phase), std::sin(2.3 * phase)));
    }
    pressed.world->SetMotion(body.id, x, v);
  }
}

const std::vector<Contact<double>>& ReadContacts(const World& world) {
  return std::get<State<double>>(world.Bodies()[0].state).contacts;
}

bool IsDeep(const World& world, const Contact<double>& contact) {
  const auto& state = std::get<State<double>>(world.Bodies()[0].state);
  const double depth = -(state.origin + state.positions[contact.vertex]).z();
  return depth > world.Blueprints()[0].full.contact.fadeDepth;
}

// Contacts with the ground that touch in one and not in the other, slipped in between, or crossed δ.
void CountChanges(const World& from, const World& to, PressedCase& pressed) {
  const Vector3d shift =
      std::get<State<double>>(to.Bodies()[0].state).origin - std::get<State<double>>(from.Bodies()[0].state).origin;
  pressed.contacts = 0;
  for (const Contact<double>& contact : ReadContacts(from)) {
    pressed.contacts += contact.touching ? 1 : 0;
    const auto& after = ReadContacts(to);
    const auto same = std::find_if(after.begin(), after.end(),
                                   [&](const Contact<double>& each) { return each.vertex == contact.vertex; });
    const bool kept = same != after.end() && same->touching == contact.touching &&
                      IsDeep(from, contact) == IsDeep(to, *same) &&
                      (!contact.touching || (same->anchor + shift - contact.anchor).norm() < 1e-12);
    pressed.changed += kept ? 0 : 1;
  }
}

std::vector<Vector3d> Vibrate(PressedCase& pressed, int substeps, bool isWatched) {
  World world(*pressed.world, MakePressing(substeps));
  for (int tick = 0; tick < kVibrateTicks; ++tick) {
    (void)world.Step();
    if (isWatched) CountChanges(*pressed.world, world, pressed);
  }
  return ReadAllPositions(world);
}

// A scene that contacts begin and end in.
struct ThroughCase {
  const char* key;
  ContactScene scene;
  std::array<std::vector<Vector3d>, kThroughSubsteps.size() + 1> ends{};  // the last is the reference
};

ThroughCase MakeThroughCase(const char* key, ContactScene scene, bool hasFriction) {
  for (Blueprint& blueprint : scene.blueprints) {
    if (!hasFriction) blueprint.full.contact.friction = 0;
  }
  return {.key = key, .scene = std::move(scene)};
}

std::vector<Vector3d> PlayThrough(const ContactScene& scene, int substeps) {
  WorldSettings settings = MakePressing(substeps);
  settings.gravity = WorldSettings{}.gravity;
  const std::unique_ptr<World> world = MakeSceneWorld(scene, settings);
  for (int tick = 0; tick < scene.ticks; ++tick) (void)world->Step();
  return ReadAllPositions(*world);
}

// The slope of the least-squares line through the logarithms of error over substeps, which double.
double FindFittedOrder(const std::array<double, kSubsteps.size()>& errors) {
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double finer = static_cast<double>(i) - (static_cast<double>(errors.size()) - 1) / 2;
    sum += finer * std::log2(errors[i]);
    squares += finer * finer;
  }
  return -sum / squares;
}

void MeasureOrdersThroughContact(Bench& bench) {
  const std::vector<ContactScene> scenes = MakeContactScenes();
  std::array<ThroughCase, 4> cases{MakeThroughCase("order_rk4_bounce", scenes[0], true),
                                   MakeThroughCase("order_rk4_bounce_without_friction", scenes[0], false),
                                   MakeThroughCase("order_rk4_slide", scenes[1], true),
                                   MakeThroughCase("order_rk4_slide_without_friction", scenes[1], false)};
  constexpr std::size_t kRuns = kThroughSubsteps.size() + 1;
  const bool done = RunTrials(bench, cases.size() * kRuns, [&](std::size_t i) {
    const std::size_t run = i % kRuns;
    const int substeps = run == kThroughSubsteps.size() ? kReferenceSubsteps : kThroughSubsteps[run];
    cases[i / kRuns].ends[run] = PlayThrough(cases[i / kRuns].scene, substeps);
  });
  if (!done) return;
  for (const ThroughCase& each : cases) {
    std::array<double, kThroughSubsteps.size()> errors{};
    for (std::size_t run = 0; run < errors.size(); ++run) errors[run] = FindRms(each.ends[run], each.ends.back());
    const double order = FindFittedOrder(errors);
    bench.results.rows.push_back({{"experiment", "order_through_contact"},
                                  {"case", each.key},
                                  {"order", order},
                                  {"substeps", kThroughSubsteps},
                                  {"errors", errors}});
    bench.results.AddFigure(each.key, order);
  }
}

}  // namespace

void MeasureOrdersInContact(Bench& bench) {
  std::array<PressedCase, 2> cases{{{"cube pressed on the ground", "order_rk4_in_contact", 1, 2},
                                    {"cube pressed on another", "order_rk4_between_bodies", 2, 2}}};
  for (PressedCase& each : cases) Press(each);
  constexpr std::size_t kRuns = kSubsteps.size() + 1;
  std::array<std::array<std::vector<Vector3d>, kRuns>, cases.size()> ends;
  const bool done = RunTrials(bench, cases.size() * kRuns, [&](std::size_t i) {
    const std::size_t run = i % kRuns;
    const bool isReference = run == kSubsteps.size();
    ends[i / kRuns][run] = Vibrate(cases[i / kRuns], isReference ? kReferenceSubsteps : kSubsteps[run], isReference);
  });
  if (!done) return;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    PressedCase& each = cases[i];
    for (std::size_t run = 0; run < kSubsteps.size(); ++run) {
      each.errors[run] = FindRms(ends[i][run], ends[i][kSubsteps.size()]);
    }
    const double order = FindFittedOrder(each.errors);
    bench.results.rows.push_back({{"experiment", "order_in_contact"},
                                  {"case", each.name},
                                  {"order", order},
                                  {"substeps", kSubsteps},
                                  {"errors", each.errors},
                                  {"ground_contacts", each.contacts},
                                  {"changed", each.changed}});
    bench.results.AddFigureAtLeast(each.key, order, 3.8);
  }
  MeasureOrdersThroughContact(bench);
}

}  // namespace wobble::bench
