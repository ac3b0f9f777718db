// Compares bodies stepped in lanes with the plain reference, and checks that the bits do not depend on the number of
// lanes.
#include "server/physics/packs/batch_step.h"

#include <gtest/gtest.h>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/ring.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/step/first_substeps.h"
#include "server/physics/step/island_step.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr StepRules kRules;

// Bodies of one blueprint on a floor, each with its own position, deformation, load and pushes.
template <class Real>
struct Bodies {
  Bodies(const Blueprint& made, std::size_t count) : blueprint(made), states(count), members(count) {
    const Obstacle floor;
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = static_cast<double>(i);
      states[i] = MakeState<Real>(blueprint, Vector3d(3 * number, 0, blueprint.reach * (0.8 + 0.05 * number)),
                                  Vector3d(0.3, blueprint.full.planar ? 0 : 0.1 * number, -0.2 * number));
      for (std::size_t v = 0; v < states[i].positions.size(); ++v) {
        const double phase = 1.7 * static_cast<double>(v) + number;
        states[i].positions[v].x() += static_cast<Real>(0.02 * blueprint.size * std::sin(phase));
      }
      Member<Real>& member = members[i];
      member.blueprint = &blueprint;
      member.state = &states[i];
      member.load.acceleration = Vector3<Real>(0, 0, Real(-9.81));
      member.load.gasFactor = static_cast<Real>(1 + 0.1 * number);
      member.load.stiffnessFactor = static_cast<Real>(1 + 0.05 * number);
      member.load.wind =
          Vector3<Real>(Real(2), blueprint.full.planar ? Real(0) : Real(0.5), static_cast<Real>(-number));
      for (std::size_t spring = i; spring < states[i].torn.size(); spring += 7) states[i].torn[spring] = 1;
      member.load.torn = states[i].torn;
      if (i % 2 == 1) member.pushes.push_back({0, Vector3<Real>(5, 0, 3)});
      member.load.pushes = member.pushes;
      member.surfaces.push_back(MakeSurface<Real>(floor, states[i].origin));
    }
    FindAllContacts();
  }

  void FindAllContacts() {
    std::vector<Contact<Real>> spare;
    for (std::size_t i = 0; i < members.size(); ++i) {
      members[i].survey = MakeSurvey<Real>(blueprint.Read<Real>().masses, states[i].positions, states[i].velocities);
      FindContacts<Real>({.surfaces = members[i].surfaces,
                          .x = states[i].positions,
                          .v = states[i].velocities,
                          .survey = members[i].survey,
                          .duration = static_cast<Real>(kRules.duration)},
                         states[i].contacts, spare);
    }
  }

  // Steps the bodies that ask for as many substeps as the first, at most `width`, in kernels of at most `width` lanes.
  // Returns their indices.
  std::vector<std::size_t> StepInLanes(int width) {
    std::vector<std::size_t> stepped;
    std::vector<Member<Real>*> together;
    std::vector<Island> islands;
    const int substeps = FindSubsteps(0);
    for (std::size_t i = 0; i < members.size() && together.size() < static_cast<std::size_t>(width); ++i) {
      if (FindSubsteps(i) != substeps) continue;
      stepped.push_back(i);
      together.push_back(&members[i]);
      islands.push_back({.memberBegin = islands.size(), .memberEnd = islands.size() + 1});
    }
    std::array<IslandOutcome, kWidestPack> outcomes;
    StepBatch<Real>(together, {}, islands, substeps, kRules, FindSweepKernels<Real>(width), nullptr, scratch, outcomes);
    return stepped;
  }

  void StepPlainly(std::size_t i) {
    Member<Real>* member = &members[i];
    StepIsland<Real>({&member, 1}, {}, FindSubsteps(i), kRules, nullptr, scratch.system);
  }

  int FindSubsteps(std::size_t i) {
    Member<Real>* member = &members[i];
    std::vector<VertexLoad> loads;
    std::vector<std::size_t> begins;
    return FindFirstSubsteps<Real>({&member, 1}, {}, kRules, loads, begins);
  }

  const Blueprint& blueprint;
  std::vector<State<Real>> states;
  std::vector<Member<Real>> members;
  BatchScratch<Real> scratch;
};

// Blueprints with rare terms (kernels/rare_terms.h): one with each term, and one with all that can be combined.
std::vector<Blueprint> MakeRareKinds() {
  std::vector<Blueprint> kinds{
      MakeRing({.material = {.mass = 4, .stiffness = 1500, .gas = 100, .ambientPressure = 50}}),
      MakeRing({.points = 13, .layers = 3})};
  ClothDefinition cloth;
  cloth.points = {7, 5};
  kinds.push_back(MakeCloth(cloth));
  cloth.tearStretch = 1.5;
  cloth.material.drag = 0;
  kinds.push_back(MakeCloth(cloth));
  ClothDefinition card;
  card.name = "card";
  card.points = {7, 5};
  card.bendStiffness = 0.2;
  card.material.drag = 0;
  kinds.push_back(MakeCloth(card));
  card.name = "card that repels and tears";  // repulsion is not swept by rows
  card.points = {6, 9};
  card.tearStretch = 1.5;
  card.material.drag = 0.6;
  card.material.repulsion = 1e-6;
  kinds.push_back(MakeCloth(card));
  Blueprint cube = MakeLattice(MakeJellyCube(0.1));
  cube.full.repulsion = 0.001;
  cube.full.drag = 0.6;
  cube.full.tearStretch = 2;
  FinishBlueprint(cube);
  kinds.push_back(std::move(cube));
  BallDefinition ball = MakeMeasuredBall(0.2);
  ball.material.drag = 0.6;
  ball.material.repulsion = 0.01;
  kinds.push_back(MakeBall(ball));
  for (const Side fixed : {Side::kNone, Side::kLowX}) {
    SolidDefinition box = MakeSolidBox({3, 2, 2}, 0.4);
    box.fixed = fixed;
    kinds.push_back(MakeSolid(box));
  }
  return kinds;
}

std::vector<Blueprint> MakeKinds() {
  std::vector<Blueprint> kinds{MakeBall(MakeMeasuredBall(0.2)), MakeLattice(MakeJellyCube(0.1)),
                               MakePair(PairDefinition{})};
  LatticeDefinition sheet;
  sheet.cells = {6, 0, 3};
  sheet.poissonRatio = FindPoissonRatio(sheet.cells);
  kinds.push_back(MakeLattice(sheet));
  Blueprint held = MakeBall(MakeMeasuredBall(0.2));
  held.full.fixed = {3, 40};
  FinishBlueprint(held);
  kinds.push_back(std::move(held));
  ClothDefinition cloth;
  cloth.name = "cloth in vacuo";
  cloth.points = {21, 6};
  cloth.material.drag = 0;
  kinds.push_back(MakeCloth(cloth));
  for (Blueprint& rare : MakeRareKinds()) kinds.push_back(std::move(rare));
  return kinds;
}

template <class Real>
double FindLargestDifference(const State<Real>& a, const State<Real>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    largest = std::max({largest, double{(a.positions[i] - b.positions[i]).norm()},
                        double{(a.velocities[i] - b.velocities[i]).norm()} * kRules.duration});
  }
  return largest;
}

template <class Real>
class BatchStepTest : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchStepTest, Precisions);

TYPED_TEST(BatchStepTest, DoesWhatThePlainReferenceDoes) {
  using Real = TypeParam;
  for (const Blueprint& kind : MakeKinds()) {
    for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
      Bodies<Real> inLanes(kind, 5);
      Bodies<Real> plainly(kind, 5);
      const std::vector<std::size_t> stepped = inLanes.StepInLanes(kernel.width);
      for (const std::size_t i : stepped) {
        plainly.StepPlainly(i);
        const double rounding = sizeof(Real) == 4 ? 2e-6 : 1e-14;
        EXPECT_LT(FindLargestDifference(inLanes.states[i], plainly.states[i]), rounding)
            << kind.name << ", " << kernel.width << " lanes, body " << i;
        EXPECT_NEAR(inLanes.members[i].error, plainly.members[i].error, 0.01 * plainly.members[i].error + 1e-9);
      }
    }
  }
}

TYPED_TEST(BatchStepTest, GivesTheSameBitsInAnyLaneOfAnyWidth) {
  using Real = TypeParam;
  for (const Blueprint& kind : MakeKinds()) {
    Bodies<Real> alone(kind, 16);
    const Island island{.memberEnd = 1};
    std::vector<bool> known(16, false);
    for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
      Bodies<Real> together(kind, 16);
      for (const std::size_t i : together.StepInLanes(kernel.width)) {
        Member<Real>* member = &alone.members[i];
        std::array<IslandOutcome, kWidestPack> outcomes;
        if (!known[i]) {
          StepBatch<Real>({&member, 1}, {}, {&island, 1}, alone.FindSubsteps(i), kRules, FindSweepKernels<Real>(1),
                          nullptr, alone.scratch, outcomes);
        }
        known[i] = true;
        EXPECT_EQ(together.members[i].error, alone.members[i].error) << kind.name << ", " << kernel.width << " lanes";
        EXPECT_EQ(HashState(together.states[i], kHashSeed), HashState(alone.states[i], kHashSeed))
            << kind.name << ", " << kernel.width << " lanes, body " << i;
      }
    }
  }
}

TEST(BatchStepTest, WorldIsTheSameWhateverThePacks) {
  std::vector<std::uint64_t> hashes;
  for (const int widest : {1, 8, 16}) {
    WorldSettings settings;
    settings.widestPack = widest;
    settings.threads = 2;
    World world(settings);
    world.AddBlueprint(MakeBall(MakeMeasuredBall(0.2)));
    world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
    world.AddBlueprint(MakeSolid(MakeSolidBox({2, 2, 2}, 0.3)));
    world.AddObstacle(Obstacle{});
    for (int i = 0; i < 30; ++i) {
      world.AddBody(static_cast<std::uint8_t>(i % 3), Vector3d(2.5 * i, 0, 1.2 + 0.1 * i), Vector3d(0, 0.1 * i, 0));
    }
    for (int tick = 0; tick < 90; ++tick) world.Step();
    hashes.push_back(world.Hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

// Torn springs are left out of their rows at once; a quarter of a second later the blueprint is rebuilt without them.
TEST(BatchStepTest, ClothTearsAlikeInRowsOfAnyWidth) {
  std::vector<std::uint64_t> hashes;
  for (const int widest : {1, 8, 16}) {
    WorldSettings settings;
    settings.widestPack = widest;
    settings.wind = Vector3d(0, 3, 0);
    World world(settings);
    ClothDefinition curtain;
    curtain.points = {17, 9};
    curtain.pinned = Pinned::kEdge;
    curtain.tearStretch = 1.25;
    world.AddBlueprint(MakeCloth(curtain));
    world.AddBlueprint(MakeBall(MakeMeasuredBall(0.2)));
    const BodyId id = world.AddBody(0, Vector3d(0, 0, 2));
    world.AddBody(1, Vector3d(0, -1.5, 1.6), Vector3d(0, 12, 0));
    std::uint32_t torn = 0;
    for (int tick = 0; tick < 60; ++tick) torn += world.Step().torn;
    EXPECT_GT(torn, 0U);
    const Blueprint& left = world.BlueprintOf(world.ReadBody(id));
    EXPECT_LT(left.full.springs.size(), MakeCloth(curtain).full.springs.size());
    EXPECT_GT(left.ReadGridPlan<float>().rows, 0U) << "what is left of a grid is one";
    hashes.push_back(world.Hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(BatchStepTest, GridsGoByRowsWhereTheyAreFew) {
  EXPECT_FALSE(GoesByRows<float>(MakeBall(MakeMeasuredBall()), 1));
  const Blueprint cube = MakeLattice(MakeJellyCube());
  EXPECT_TRUE(GoesByRows<float>(cube, 1));
  EXPECT_FALSE(GoesByRows<float>(cube, 16));
  const Blueprint cloth = MakeCloth(ClothDefinition{});
  EXPECT_TRUE(CanGoInPack<float>(cloth));
  EXPECT_TRUE(GoesByRows<float>(cloth, 16)) << "wind adds up otherwise in lanes";
  ClothDefinition card;
  card.bendStiffness = 0.2;
  card.material.drag = 0;
  EXPECT_TRUE(GoesByRows<float>(MakeCloth(card), 16)) << "so do hinges";
  card.material.repulsion = 1e-6;
  EXPECT_FALSE(GoesByRows<float>(MakeCloth(card), 16));
}

TEST(BatchStepTest, PlanHasNoTornSprings) {
  ClothDefinition cloth;
  cloth.tearStretch = 1.5;
  const Blueprint whole = MakeCloth(cloth);
  std::vector<std::uint8_t> torn(whole.full.springs.size(), 0);
  torn[3] = torn[20] = 1;
  const Blueprint left = MakeTornBlueprint(whole, torn);
  EXPECT_EQ(left.singlePlan.arcs.size(), whole.singlePlan.arcs.size() - 2);
  EXPECT_EQ(left.fullPlan.draggedFaces.size(), left.full.faces.size());
}

TEST(BatchStepTest, RefusesWhatTheSweepDoesNotKnow) {
  Blueprint ball = MakeBall(MakeMeasuredBall());
  EXPECT_TRUE(CanGoInPack<float>(ball));
  SetContactLaw(ball, ContactLaw::kMagnetic);
  EXPECT_TRUE(CanGoInPack<float>(ball));
  SetContactLaw(ball, ContactLaw::kBacktracking);
  EXPECT_FALSE(CanGoInPack<float>(ball));
  SetContactLaw(ball, ContactLaw::kPenalty);
  for (const Blueprint& kind : MakeRareKinds()) {
    EXPECT_TRUE(CanGoInPack<float>(kind)) << kind.name;
    EXPECT_TRUE(kind.singlePlan.isRare) << kind.name;
  }
}

}  // namespace
}  // namespace wobble::physics
