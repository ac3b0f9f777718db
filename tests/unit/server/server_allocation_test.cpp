// A warm server allocates nothing in step, capture and encoding.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>

#include "server/snapshots/body_captures.h"
#include "server/snapshots/encoder.h"
#include "tests/support/game.h"
#include "tests/support/pace.h"

namespace {
std::atomic<bool> countsAllocations{false};
std::atomic<std::uint64_t> allocations{0};

void* Allocate(std::size_t size) {
  if (countsAllocations.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(size == 0 ? 1 : size);
}
void* AllocateOrThrow(std::size_t size) {
  if (void* memory = Allocate(size)) return memory;
  throw std::bad_alloc();
}
void* AllocateAligned(std::size_t size, std::align_val_t alignment) {
  if (countsAllocations.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(step, (size + step - 1) / step * step)) return memory;
  throw std::bad_alloc();
}
}  // namespace

// All forms of new and delete that the library may call, for the whole test program. They count only while a test asks
// for it.
void* operator new(std::size_t size) { return AllocateOrThrow(size); }
void* operator new[](std::size_t size) { return AllocateOrThrow(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return Allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return Allocate(size); }
void* operator new(std::size_t size, std::align_val_t alignment) { return AllocateAligned(size, alignment); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return AllocateAligned(size, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace wobble::server {
namespace {

TEST(Server, StepCaptureAndEncodeDoNotAllocateOnceWarm) {
  const scenes::Scene scene = test::LoadShippedScene("arena");
  physics::World world(scenes::MakeWorldSettings(scene, 1.0 / 60, 1));
  const auto placed = scenes::FillWorld(scene, 1, world);
  std::vector<CapturedBlueprint> blueprints;
  for (const auto& blueprint : world.Blueprints()) blueprints.push_back(CaptureBlueprint(blueprint));
  for (std::uint32_t i = 1; i <= 8; ++i) {
    (void)world.AddBody(static_cast<std::uint8_t>(scene.player.blueprint), scenes::FindSpawn(scene.player, i));
  }
  BodyCaptures captures;
  Encoder encoder;
  const auto play = [&](int from, int to) {
    for (int tick = from; tick < to; ++tick) {
      for (const physics::Body& body : world.Bodies()) {
        const double turn = 0.01 * tick + body.id;
        const physics::Control control{
            .moveX = std::cos(turn), .moveY = std::sin(turn), .jump = tick % 90 == 0, .stiffen = tick % 200 < 50};
        world.SetControl(body.id, control, {});
      }
      world.Step();
      captures.Follow(world, world.Tick());
      if (tick % 2 != 0) continue;
      encoder.Follow(captures.Bodies(), world.Tick());
      for (std::size_t i = 0; i < captures.Bodies().size(); ++i) {
        const CapturedBody& captured = captures.Read(world, i);
        for (std::size_t quality = 0; quality < kQualities; ++quality) {
          (void)encoder.Encode(i, quality, captured, blueprints[captured.blueprint]);
        }
      }
    }
  };
  play(0, test::Shorten(400));
  if (test::kIsSanitized) GTEST_SKIP() << "not warm yet";
  allocations = 0;
  countsAllocations = true;
  play(400, 700);
  countsAllocations = false;
  EXPECT_EQ(allocations.load(), 0U);
  EXPECT_EQ(captures.Bodies().size(), 20U);

  countsAllocations = true;  // checks that the counter works
  const auto one = std::make_unique<int>(1);
  countsAllocations = false;
  EXPECT_EQ(allocations.load(), 1U);
}

}  // namespace
}  // namespace wobble::server
