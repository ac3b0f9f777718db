// The plays are generated here and not taken from a scene, because their figures are compared between versions, while
// scenes change for the sake of players. Targets and jumps follow from the seed and from the positions of the bodies.
#include "tests/bench/codec/recording.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "tests/bench/codec/play.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/random.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kTicksPerFrame = 2;  // at 60 Hz
constexpr int kWarmUpTicks = 120;
constexpr std::uint64_t kTrainingSeed = 0x7EA1;

Recording BeginRecording(const World& world) {
  const Blueprint& blueprint = world.Blueprints().front();
  Recording recording;
  recording.blueprint = server::CaptureBlueprint(blueprint, TrainBasesAsServer(blueprint));
  recording.obstacles = server::CaptureObstacles(world.Obstacles());
  recording.faces = blueprint.full.faces;
  return recording;
}

// Adds a frame with the bodies of the recording's blueprint, the first of the world.
void AddFrame(const World& world, Recording& recording) {
  std::vector<server::CapturedBody> frame;
  for (const Body& body : world.Bodies()) {
    if (body.blueprint != 0) continue;
    const std::size_t place = frame.size();
    // Like the server, starts from the last capture.
    frame.push_back(recording.frames.empty() ? server::CapturedBody{} : recording.frames.back()[place]);
    server::CaptureBody(world, body, frame.back());
    recording.speeds.push_back(FindVelocity(world, body).norm());
    recording.deformations.push_back(FindDeformation(frame.back(), recording.blueprint));
  }
  recording.frames.push_back(std::move(frame));
}

Recording RecordPlay(const Blueprint& blueprint, Pattern pattern, std::uint64_t seed, double seconds) {
  World world{WorldSettings{}};
  for (const Obstacle& each : MakeArena()) world.AddObstacle(each);
  world.AddBlueprint(blueprint);
  std::vector<Actor> actors;
  for (const auto& [x, y] : {std::array{-1, -1}, std::array{1, -1}, std::array{1, 1}, std::array{-1, 1}}) {
    actors.emplace_back(seed, actors.size());
    world.AddBody(0, Vector3d(1.5 * x, 1.5 * y, 1.5));
  }
  Recording recording = BeginRecording(world);
  const int ticks = kWarmUpTicks + static_cast<int>(seconds * kFrameHz) * kTicksPerFrame;
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < actors.size(); ++i) {
      world.SetControl(world.Bodies()[i].id, actors[i].Act(pattern, world), kPlayLimits);
    }
    (void)world.Step();
    if (tick >= kWarmUpTicks && tick % kTicksPerFrame == 0) AddFrame(world, recording);
  }
  return recording;
}

}  // namespace

server::Bases TrainBasesAsServer(const Blueprint& blueprint) {
  return server::TrainBases(blueprint,
                            server::RecordPlay(blueprint, WorldSettings{}.gravity, kPlayLimits, kTrainingSeed));
}

Recording RecordBalls(Pattern pattern, std::uint64_t seed, double seconds, double gas) {
  return RecordPlay(MakePlayedBall(gas), pattern, seed, seconds);
}

Recording RecordLattices(Pattern pattern, std::uint64_t seed, double seconds) {
  LatticeDefinition cube;
  cube.cellSize = 0.5;
  return RecordPlay(MakeLattice(cube), pattern, seed, seconds);
}

Recording RecordCloth(std::uint64_t seed, double seconds) {
  ClothDefinition definition;
  definition.points = {32, 32};
  definition.spacing = 0.1;
  definition.pinned = Pinned::kTopCorners;
  WorldSettings settings;
  settings.wind = Vector3d(1, 4, 0);
  World world(settings);
  const Blueprint cloth = MakeCloth(definition);
  world.AddBlueprint(cloth);
  const std::uint8_t thrown = world.AddBlueprint(MakeBall(DescribeBall(1)));
  world.AddObstacle(Obstacle{});
  world.AddBody(0, Vector3d(0, 0, 2.2));
  Random random(seed);
  const auto throwBall = [&] {
    const Vector3d velocity = random.DrawWithin({-1, 7, 1}, {1, 7, 3});
    return world.AddBody(thrown, random.DrawWithin({-1, -3, 1.5}, {1, -3, 2.5}), velocity);
  };
  BodyId ball = throwBall();
  Recording recording = BeginRecording(world);
  const int ticks = kWarmUpTicks + static_cast<int>(seconds * kFrameHz) * kTicksPerFrame;
  for (int tick = 0; tick < ticks; ++tick) {
    if (tick % 90 == 89) {
      world.RemoveBody(ball);
      ball = throwBall();
    }
    (void)world.Step();
    if (tick >= kWarmUpTicks && tick % kTicksPerFrame == 0) AddFrame(world, recording);
  }
  return recording;
}

double FindDeformation(const server::CapturedBody& body, const server::CapturedBlueprint& blueprint) {
  const protocol::Quaternion back = protocol::Conjugate(body.pose.rotation);
  double sum = 0;
  for (std::size_t i = 0; i < body.vertices.size(); ++i) {
    const protocol::Vector3 off = protocol::Rotate(back, body.vertices[i] - body.pose.centroid) - blueprint.rest[i];
    sum += static_cast<double>(protocol::Dot(off, off));
  }
  return std::sqrt(sum / static_cast<double>(body.vertices.size())) / static_cast<double>(blueprint.size);
}

double FindMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace wobble::bench
