// Checks that an island which all threads step together has the same bits whatever their number. Continuous integration
// runs these tests under ThreadSanitizer as well.
#include <gtest/gtest.h>

#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr int kSide = 4;
constexpr int kTicks = 4;

struct Press {
  Integrator integrator = Integrator::kRungeKutta4;
  ContactLaw law = ContactLaw::kPenalty;
  double speed = 2;  // at which neighbours run into one another, m/s
};

// A square of balls that run into one another: 2592 vertices, so one island that all threads step.
std::unique_ptr<World> MakePress(const Press& press, int threads) {
  WorldSettings settings;
  settings.threads = threads;
  auto world = std::make_unique<World>(settings);
  Blueprint blueprint = MakeBall(BallDefinition{});
  SetIntegrator(blueprint, press.integrator);
  SetContactLaw(blueprint, press.law);
  world->AddBlueprint(std::move(blueprint));
  world->AddObstacle(Obstacle{});
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vector3d place(i % kSide - 0.5 * (kSide - 1), i / kSide - 0.5 * (kSide - 1), 0);
    world->AddBody(0, 1.02 * place + Vector3d(0, 0, 0.5), -press.speed * place);
  }
  return world;
}

struct Played {
  std::uint64_t hash = 0;
  bool allTouch = true;       // at the end every body touches another: they are one island
  bool steppedAgain = false;  // in at least one tick
};

Played Play(const Press& press, int threads) {
  const auto world = MakePress(press, threads);
  Played played;
  for (int tick = 0; tick < kTicks; ++tick) {
    const StepReport report = world->Step();
    played.steppedAgain |= report.allSubsteps > report.substeps;
  }
  for (const Body& body : world->Bodies()) played.allTouch &= body.touchesBody;
  played.hash = world->Hash();
  return played;
}

class LargeIsland : public testing::TestWithParam<Press> {};

TEST_P(LargeIsland, IsTheSameForAnyNumberOfThreads) {
  const Played alone = Play(GetParam(), 1);
  EXPECT_TRUE(alone.allTouch);
  EXPECT_EQ(Play(GetParam(), 2).hash, alone.hash);
  EXPECT_EQ(Play(GetParam(), 4).hash, alone.hash);
}
INSTANTIATE_TEST_SUITE_P(Presses, LargeIsland,
                         testing::Values(Press{}, Press{.integrator = Integrator::kSemiImplicitEuler},
                                         Press{.law = ContactLaw::kBacktracking}));

// Stepping again puts positions, velocities and contacts back to the tick's begin.
TEST(LargeIsland, IsSteppedAgainAlike) {
  const Press press{.speed = 6};
  const Played alone = Play(press, 1);
  EXPECT_TRUE(alone.steppedAgain);
  EXPECT_EQ(Play(press, 4).hash, alone.hash);
}

}  // namespace
}  // namespace wobble::physics
