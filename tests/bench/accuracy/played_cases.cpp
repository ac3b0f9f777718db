// The cases for judging the server's stepping where only its own error matters.
//
// Each case restarts every second, so that an undamped ball stretched by a tenth is well-posed: within a second,
// neighbouring motions diverge little. An undamped sheet that is released horizontally and crumples is ill-posed, and
// is included to show it: its errors are those of a second of chaos at any step, and it counts in no figure.
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/ring.h"
#include "tests/bench/accuracy/played.h"

namespace wobble::bench {
namespace {

using namespace physics;

const Vector3d kDown(0, 0, -9.81);

PlayedCase MakeCase(const std::string& name, Blueprint blueprint, const Vector3d& gravity) {
  PlayedCase made;
  made.name = name;
  made.blueprint = std::make_shared<const Blueprint>(std::move(blueprint));
  made.equations.blueprint = made.blueprint.get();
  made.equations.gravity = gravity;
  made.x = made.blueprint->rest;
  made.v.assign(made.x.size(), Vector3d::Zero());
  return made;
}

// Stretches along z and shrinks across by half of that: the volume hardly changes.
PlayedCase Stretch(PlayedCase made, double strain) {
  const bool planar = made.blueprint->full.planar;
  const double across = planar ? 1 - strain : 1 - strain / 2;
  for (Vector3d& x : made.x) x = Vector3d(across * x.x(), planar ? x.y() : across * x.y(), (1 + strain) * x.z());
  return made;
}

PlayedCase Throw(PlayedCase made, const Vector3d& velocity, const Vector3d& spin) {
  for (std::size_t i = 0; i < made.x.size(); ++i) made.v[i] += velocity + spin.cross(made.x[i]);
  return made;
}

// Adds the plane z = 0 and puts the lowest vertex `height` above it.
PlayedCase Drop(PlayedCase made, double height) {
  double lowest = 0;
  for (const Vector3d& x : made.x) lowest = std::min(lowest, x.z());
  for (Vector3d& x : made.x) x.z() += height - lowest;
  made.equations.obstacles.push_back(Obstacle{});
  return made;
}

// The losses of server/physics/step/losses.h act between ticks; the reference solves the equations within them.
void LeaveOutLosses(Material& material) {
  material.gasDampingRatio = 0;
  material.rollingResistance = 0;
}

// A soft ball as in the scenes.
Blueprint MakeSoftBall(double dampingRatio) {
  BallDefinition ball;
  ball.material.dampingRatio = dampingRatio;
  ball.material.friction = 0;
  LeaveOutLosses(ball.material);
  return MakeBall(ball);
}

// The ball of the project's documents: 162 vertices of 0.25 kg, highest frequency 132 rad/s.
Blueprint MakeFirmBall(double dampingRatio) {
  BallDefinition ball;
  ball.radius = 1;
  ball.material.mass = 0.25 * 162;
  ball.material.stiffness = 750;
  ball.material.gas = 1000;
  ball.material.dampingRatio = dampingRatio;
  ball.material.friction = 0;
  LeaveOutLosses(ball.material);
  return MakeBall(ball);
}

Blueprint MakeCube(double dampingRatio) {
  LatticeDefinition cube;
  cube.dampingRatio = dampingRatio;
  cube.friction = 0;
  cube.rollingResistance = 0;
  return MakeLattice(cube);
}

Blueprint MakePlate(double dampingRatio) {
  LatticeDefinition plate;
  plate.cells = {8, 0, 4};
  plate.cellSize = 0.15;
  plate.dampingRatio = dampingRatio;
  return MakeLattice(plate);
}

Blueprint MakeSheet(Orientation orientation, Pinned pinned, double dampingRatio, double drag) {
  ClothDefinition cloth;
  cloth.points = {10, 10};
  cloth.orientation = orientation;
  cloth.pinned = pinned;
  cloth.material.dampingRatio = dampingRatio;
  cloth.material.drag = drag;
  return MakeCloth(cloth);
}

// A cloth that hangs by its upper edge and swings.
PlayedCase MakeClothPendulum(const std::string& name, double dampingRatio, double drag) {
  PlayedCase made = MakeCase(name, MakeSheet(Orientation::kVertical, Pinned::kEdge, dampingRatio, drag), kDown);
  const double top = made.x[0].z();
  for (std::size_t i = 0; i < made.x.size(); ++i) made.v[i] = Vector3d(0, 1.5 * (top - made.x[i].z()), 0);
  return made;
}

// A cloth that hangs by two corners, released level with them.
PlayedCase MakeFallingSheet(const std::string& name, double dampingRatio, double drag) {
  return MakeCase(name, MakeSheet(Orientation::kHorizontal, Pinned::kTopCorners, dampingRatio, drag), kDown);
}

Blueprint MakeLayeredRing(int layers, double dampingRatio) {
  RingDefinition ring;
  ring.layers = layers;
  ring.material.dampingRatio = dampingRatio;
  LeaveOutLosses(ring.material);
  return MakeRing(ring);
}

}  // namespace

std::vector<PlayedCase> MakePlayedCases(bool quick) {
  const Vector3d none = Vector3d::Zero();
  std::vector<PlayedCase> cases;
  const auto add = [&](PlayedCase made) { cases.push_back(std::move(made)); };
  add(Stretch(MakeCase("firm ball, undamped", MakeFirmBall(0), none), 0.05));
  add(Drop(MakeCase("soft ball, damped, bouncing", MakeSoftBall(0.2), kDown), 1));
  add(Stretch(MakeCase("cube, undamped", MakeCube(0), none), 0.05));
  add(Throw(Stretch(MakeCase("cube, damped, tumbling in flight", MakeCube(0.1), kDown), 0.1), {1, 0, 9}, {5, 3, 1}));
  add(Stretch(MakeCase("plate of 8 x 4 cells, undamped", MakePlate(0), none), 0.05));
  add(MakeClothPendulum("cloth, undamped, swinging", 0, 0));
  add(Stretch(MakeCase("ring of three layers, damped", MakeLayeredRing(3, 0.2), none), 0.1));
  if (quick) return cases;
  add(Drop(MakeCase("firm ball, undamped, bouncing", MakeFirmBall(0), kDown), 1));
  add(Stretch(MakeCase("firm ball, damped", MakeFirmBall(0.2), none), 0.2));
  add(Throw(MakeCase("firm ball, undamped, spinning in flight", MakeFirmBall(0), kDown), {3, 0, 9}, {4, 3, 2}));
  add(Stretch(MakeCase("soft ball, undamped", MakeSoftBall(0), none), 0.1));
  add(Drop(Throw(MakeCase("cube, damped, bouncing", MakeCube(0.1), kDown), none, {1, 2, 0}), 0.5));
  add(MakeClothPendulum("cloth, damped, swinging in air", 0.2, 0.6));
  add(MakeFallingSheet("cloth, damped, let fall", 0.2, 0.6));
  add(Stretch(MakeCase("ring of 24, undamped", MakeLayeredRing(1, 0), none), 0.05));
  add(MakeFallingSheet("cloth, undamped, let fall", 0, 0));
  cases.back().isWellPosed = false;
  return cases;
}

}  // namespace wobble::bench
