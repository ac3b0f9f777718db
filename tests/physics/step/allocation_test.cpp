// Checks that no step of any method or contact law allocates once the world has warmed up. Counts calls of malloc,
// since Eigen does not use operator new.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace {

std::atomic<std::uint64_t> allocations{0};

}  // namespace

#ifndef WOBBLE_SANITIZED
extern "C" {  // glibc's own functions
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);

void* malloc(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(memory, size);
}
}
#endif

namespace wobble::physics {
namespace {

std::uint64_t CountAllocations(Integrator integrator, ContactLaw law, Precision precision) {
  WorldSettings settings;
  settings.precision = precision;
  World world(settings);
  ClothDefinition cloth;
  cloth.points = {5, 4};
  for (Blueprint blueprint : {MakeBall(BallDefinition{}), MakeLattice(MakeJellyCube(0.1)), MakeCloth(cloth)}) {
    SetIntegrator(blueprint, integrator);
    SetContactLaw(blueprint, law);
    world.AddBlueprint(std::move(blueprint));
  }
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 6; ++i) world.AddBody(static_cast<std::uint8_t>(i % 3), Vector3d(2 * i, 0, 1));
  for (int tick = 0; tick < 120; ++tick) world.Step();
  const std::uint64_t before = allocations;
  for (int tick = 0; tick < 120; ++tick) world.Step();
  return allocations - before;
}

// Counts the allocations of the ticks that push bodies for the first time.
TEST(Allocations, NoPushAllocatesInAStep) {
#ifdef WOBBLE_SANITIZED
  GTEST_SKIP() << "the sanitizer has its own malloc";
#endif
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 6; ++i) world.AddBody(0, Vector3d(3 * i, 0, 1));
  for (int tick = 0; tick < 60; ++tick) world.Step();
  std::vector<VertexForce<double>> pushes;
  for (std::uint16_t vertex = 0; vertex < 20; ++vertex) pushes.push_back({vertex, Vector3d(0, 1, 0.5)});
  std::uint64_t allocated = 0;
  for (int tick = 0; tick < 60; ++tick) {
    world.PushVertices(static_cast<BodyId>(1 + tick % 6), pushes);
    const std::uint64_t before = allocations;
    world.Step();
    allocated += allocations - before;
  }
  EXPECT_EQ(allocated, 0U);
}

TEST(Allocations, NoMethodAllocatesInAStep) {
#ifdef WOBBLE_SANITIZED
  GTEST_SKIP() << "the sanitizer has its own malloc";
#endif
  const std::uint64_t before = allocations;
  void* volatile memory = std::malloc(16);  // volatile, or the compiler leaves both out
  std::free(memory);
  ASSERT_GE(allocations - before, 1U) << "the counter counts";
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    for (const Integrator integrator :
         {Integrator::kRungeKutta4, Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet, Integrator::kLeapFrog,
          Integrator::kPositionVerlet, Integrator::kImplicitEuler}) {
      EXPECT_EQ(CountAllocations(integrator, ContactLaw::kPenalty, precision), 0U) << static_cast<int>(integrator);
    }
    for (const ContactLaw law : {ContactLaw::kMagnetic, ContactLaw::kBacktracking}) {
      EXPECT_EQ(CountAllocations(Integrator::kRungeKutta4, law, precision), 0U) << static_cast<int>(law);
    }
  }
}

}  // namespace
}  // namespace wobble::physics
