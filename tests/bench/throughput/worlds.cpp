#include "tests/bench/throughput/worlds.h"

#include <cmath>

#include "tests/bench/contact/bodies.h"

namespace wobble::bench {

using namespace physics;

namespace {

constexpr double kNoError = 1e-9;  // m/s
constexpr double kSpacing = 2.1;   // of the grid of dropped balls, m
// As in scrum, whose balls have half the radius: a square bottom that is too small for so many balls.
constexpr double kScrumHalf = 1.6;  // half the side of the bottom, m
constexpr std::size_t kScrumBalls = 16;
constexpr double kSlopeNormal = 0.6;  // horizontal part of the slopes' normal, 37°

// nRT/R carries twice the weight of ten stacked balls, J. With less, the lowest of the heap are crushed flat, and their
// contacts mean nothing.
constexpr double kHeapGas = 8000;

void AddFunnel(World& world, double half) {
  world.AddObstacle(Obstacle{});
  for (const Vector3d& side : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0)}) {
    Obstacle slope;
    slope.normal = kSlopeNormal * side + Vector3d(0, 0, 0.8);
    slope.offset = -kSlopeNormal * half;
    slope.friction = 0.2;
    world.AddObstacle(slope);
  }
}

}  // namespace

Blueprint MakeTimedBall(double gas) {
  BallDefinition ball;
  ball.radius = 1;
  ball.material.mass = 0.25 * static_cast<double>(CountVertices(ball.subdivisions));
  ball.material.stiffness = 750;
  ball.material.gas = gas;
  return MakeBall(ball);
}

WorldSettings FixSubsteps(int substeps, int threads) {
  WorldSettings settings;
  settings.errorTarget = kNoError;
  settings.maxSubsteps = substeps;
  settings.threads = threads;
  return settings;
}

std::unique_ptr<World> MakeBallsApart(std::size_t count, const WorldSettings& settings, int ticks) {
  auto world = std::make_unique<World>(settings);
  world->AddBlueprint(MakeTimedBall());
  world->AddObstacle(Obstacle{});
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  for (std::size_t i = 0; i < count; ++i) {
    const double height = 1.1 + 0.2 * static_cast<double>(i * 7 % 16);
    world->AddBody(0, Vector3d(3 * static_cast<double>(i % side), 3 * static_cast<double>(i / side), height));
  }
  for (int tick = 0; tick < ticks; ++tick) world->Step();
  return world;
}

std::unique_ptr<World> MakeBallsInFunnel(std::size_t count, const WorldSettings& settings, int ticks) {
  auto world = std::make_unique<World>(settings);
  world->AddBlueprint(MakeTimedBall(kHeapGas));
  const double size = std::cbrt(static_cast<double>(count) / kScrumBalls);
  AddFunnel(*world, kScrumHalf * size);
  const auto side = static_cast<std::size_t>(std::ceil(4 * size));
  const double middle = 0.5 * kSpacing * static_cast<double>(side - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d place(static_cast<double>(i % side), static_cast<double>(i / side % side),
                         static_cast<double>(i / (side * side)));
    // Slightly offset, because columns that stand are no crowd.
    const double aside = 0.05 * std::sin(2.4 * static_cast<double>(i));
    const double rim = 0.75 * middle;  // height of the slopes at the outer edge
    world->AddBody(0, kSpacing * place + Vector3d(aside - middle, -aside - middle, rim + 1.2));
  }
  for (int tick = 0; tick < ticks; ++tick) world->Step();
  return world;
}

std::unique_ptr<World> MakeBallsFreed(const World& world, const WorldSettings& settings) {
  auto freed = std::make_unique<World>(settings);
  for (const Blueprint& blueprint : world.Blueprints()) freed->AddBlueprint(blueprint);
  double along = 0;
  for (const Body& body : world.Bodies()) {
    const BodyId id = freed->AddBody(body.blueprint, Vector3d(along, 0, 0));
    const Vector3d way = Vector3d(along, 0, 0) - world.FindCentre(body);
    std::vector<Vector3d> positions = ReadPositions(body);
    for (Vector3d& position : positions) position += way;
    freed->SetMotion(id, positions, ReadVelocities(body));
    along += 4;
  }
  return freed;
}

Replay MakeReplay(const World& world, const WorldSettings& settings, int ticks) {
  Replay replay;
  replay.ticks = ticks;
  replay.begin = [&world, settings] {
    return [twin = std::make_shared<World>(world, settings)] { (void)twin->Step(); };
  };
  return replay;
}

Played CountPlayed(const World& world, const WorldSettings& settings, int ticks) {
  World twin(world, settings);
  for (int tick = 0; tick < Replay{}.lead; ++tick) (void)twin.Step();
  Played played;
  for (int tick = 0; tick < ticks; ++tick) {
    const StepReport report = twin.Step();
    played.substeps += static_cast<double>(report.substeps) / std::max(1U, report.awake) / ticks;
    played.allSubsteps += static_cast<double>(report.allSubsteps) / std::max(1U, report.awake) / ticks;
    played.awake += static_cast<double>(report.awake) / ticks;
  }
  return played;
}

}  // namespace wobble::bench
