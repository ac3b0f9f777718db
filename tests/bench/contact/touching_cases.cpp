// Everything has the friction, the dashpots and the losses of the shipped scenes; the crowd is that of `pitch`.
#include <algorithm>
#include <cmath>

#include "server/physics/shapes/cloth.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/touching.h"

namespace wobble::bench {
namespace {

using namespace physics;

std::unique_ptr<World> MakeEmpty(double errorTarget) {
  WorldSettings settings;
  settings.errorTarget = errorTarget;
  return std::make_unique<World>(settings);
}

std::unique_ptr<World> MakeOnFloor(double errorTarget, Blueprint blueprint) {
  auto world = MakeEmpty(errorTarget);
  world->AddBlueprint(std::move(blueprint));
  world->AddObstacle(Obstacle{});
  return world;
}

// Adds a body with a velocity and a spin, rad/s, about its centre.
void Throw(World& world, std::uint8_t blueprint, const Vector3d& place, const Vector3d& velocity,
           const Vector3d& spin) {
  const BodyId id = world.AddBody(blueprint, place);
  const std::vector<Vector3d> x = ReadPositions(world.ReadBody(id));
  std::vector<Vector3d> v;
  for (const Vector3d& each : x) v.emplace_back(velocity + spin.cross(each - place));
  world.SetMotion(id, x, v);
}

Blueprint MakeSmallCube(double friction) {
  LatticeDefinition cube = DescribeCube(20000, friction);
  cube.cells = {2, 2, 2};
  cube.cellSize = 0.2;
  return MakeLattice(cube);
}

std::unique_ptr<World> MakeThrownBall(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeBall(DescribeBall(2)));
  Throw(*world, 0, Vector3d(0, 0, 1.2), Vector3d(2, 0, 0), Vector3d(1, -3, 2));
  return world;
}

std::unique_ptr<World> MakeRollingBall(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeBall(DescribeBall(1)));
  Throw(*world, 0, Vector3d(0, 0, 0.5), Vector3d(2, 1, 0), Vector3d::Zero());
  return world;
}

std::unique_ptr<World> MakeSlidingCube(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeSmallCube(0.3));
  Throw(*world, 0, Vector3d(0, 0, 0.2), Vector3d(3, 1, 0), Vector3d(0, 0, 1));
  return world;
}

std::unique_ptr<World> MakeTumblingCube(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeLattice(LatticeDefinition{}));
  Throw(*world, 0, Vector3d(0, 0, 1.5), Vector3d(1, 0, 0), Vector3d(1, 2, 0.5));
  return world;
}

std::unique_ptr<World> MakeStack(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeSmallCube(0.6));
  for (int i = 0; i < 3; ++i) world->AddBody(0, Vector3d(0.02 * i, 0.01 * i, 0.2 + 0.42 * i));
  return world;
}

std::unique_ptr<World> MakeCollision(double errorTarget) {
  auto world = MakeEmpty(errorTarget);
  world->SetGravity(Vector3d::Zero());
  world->AddBlueprint(MakeBall(DescribeBall(2)));
  Throw(*world, 0, Vector3d(-1, 0, 0.15), Vector3d(2, 0, 0), Vector3d::Zero());
  Throw(*world, 0, Vector3d(1, 0.1, -0.15), Vector3d(-2, 0, 0), Vector3d(0, 2, 0));
  return world;
}

std::unique_ptr<World> MakeBallOnCloth(double errorTarget) {
  auto world = MakeEmpty(errorTarget);
  ClothDefinition cloth;
  cloth.points = {14, 14};
  cloth.spacing = 0.15;
  cloth.orientation = Orientation::kHorizontal;
  cloth.pinned = Pinned::kFrame;
  world->AddBlueprint(MakeCloth(cloth));
  world->AddBlueprint(MakeBall(DescribeBall(1)));
  world->AddBody(0, Vector3d(0, 0, 1));
  world->AddBody(1, Vector3d(0.1, 0.05, 1.8));
  return world;
}

// Balls that fall into a pit whose slopes press them together.
std::unique_ptr<World> MakePit(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeBall(DescribeBall(2)));
  for (const Vector3d& side : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0)}) {
    Obstacle slope;
    slope.normal = 0.6 * side + Vector3d(0, 0, 0.8);
    slope.offset = -0.3;
    slope.friction = 0.2;
    world->AddObstacle(slope);
  }
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.5 * i;
    world->AddBody(0, Vector3d(0.75 * std::cos(angle), 0.75 * std::sin(angle), 1.0 + 0.3 * i));
  }
  return world;
}

// One ball presses another into a groove.
std::unique_ptr<World> MakeSqueeze(double errorTarget) {
  auto world = MakeEmpty(errorTarget);
  world->AddBlueprint(MakeBall(DescribeBall(2)));
  for (const double side : {1.0, -1.0}) {
    Obstacle wall;
    wall.normal = Vector3d(0.8 * side, 0, 0.6);
    wall.friction = 0.5;
    world->AddObstacle(wall);
  }
  Throw(*world, 0, Vector3d(0, 0, 0.9), Vector3d(0, 0, -1), Vector3d::Zero());
  Throw(*world, 0, Vector3d(0.05, 0.03, 2), Vector3d(0, 0, -3), Vector3d::Zero());
  return world;
}

std::unique_ptr<World> MakeClothOverBall(double errorTarget) {
  auto world = MakeOnFloor(errorTarget, MakeBall(DescribeBall(2)));
  ClothDefinition cloth;
  cloth.points = {13, 13};
  cloth.spacing = 0.1;
  cloth.orientation = Orientation::kHorizontal;
  world->AddBlueprint(MakeCloth(cloth));
  world->AddBody(0, Vector3d(0, 0, 0.505));
  world->AddBody(1, Vector3d(0.03, 0.02, 1.1), Vector3d(0, 0, -0.5));
  return world;
}

constexpr int kPlayers = 8;

std::unique_ptr<World> MakePlayers(double errorTarget) {
  BallDefinition ball = DescribeBall(2);
  ball.material.stiffness = 150;
  ball.material.gas = 330;
  ball.material.dampingRatio = 0.3;
  ball.material.friction = 0.9;
  auto world = MakeOnFloor(errorTarget, MakeBall(ball));
  for (int i = 0; i < kPlayers; ++i) {
    const double angle = 0.8 * i;
    const double radius = 1.2 + 0.15 * i;
    world->AddBody(0, Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0.5));
  }
  return world;
}

// Everybody runs at the next one and jumps now and then.
void Chase(World& world, int second) {
  const ControlLimits limits{.acceleration = 12, .speed = 4, .jumpSpeed = 3};
  const std::span<const Body> bodies = world.Bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& next = bodies[(i + 1) % bodies.size()];
    const Vector3d way = world.FindCentre(next) - world.FindCentre(bodies[i]);
    const double length = std::max(1e-3, std::hypot(way.x(), way.y()));
    Control control{.moveX = 0.99 * way.x() / length, .moveY = 0.99 * way.y() / length};
    control.jump = (static_cast<int>(i) + second) % 4 == 0;
    world.SetControl(bodies[i].id, control, limits);
  }
}

}  // namespace

std::vector<TouchingCase> MakeTouchingCases(bool quick) {
  std::vector<TouchingCase> cases{{"ball, thrown with spin", &MakeThrownBall, nullptr, "bounce"},
                                  {"cube, sliding", &MakeSlidingCube, nullptr, "slide"},
                                  {"two balls, off centre", &MakeCollision},
                                  {"stack of three cubes", &MakeStack, nullptr, "stack"},
                                  {"two balls in a groove", &MakeSqueeze, nullptr, "squeeze"},
                                  {"cloth over a ball", &MakeClothOverBall, nullptr, "cloth_over_ball", false},
                                  {"eight players, chasing", &MakePlayers, &Chase, "crowd"}};
  if (quick) return cases;
  cases.push_back({"ball, sliding into a roll", &MakeRollingBall});
  cases.push_back({"cube, tumbling", &MakeTumblingCube});
  cases.push_back({"ball on a cloth in a frame", &MakeBallOnCloth});
  cases.push_back({"five balls in a pit", &MakePit});
  return cases;
}

bool TouchesAnything(const Body& body) {
  if (body.touchesBody) return true;
  return std::visit(
      [](const auto& state) {
        return std::any_of(state.contacts.begin(), state.contacts.end(),
                           [](const auto& each) { return each.touching; });
      },
      body.state);
}

}  // namespace wobble::bench
