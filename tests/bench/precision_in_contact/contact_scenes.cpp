// Materials are the defaults of the scenes. Bodies begin a little apart, so that every contact begins within the
// motion.
#include "tests/bench/precision_in_contact/contact_scenes.h"

#include <cmath>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "tests/bench/contact/bodies.h"

namespace wobble::bench {

using namespace physics;

namespace {

Blueprint MakeLosslessBall(int subdivisions) {
  BallDefinition ball = DescribeBall(subdivisions);
  ball.material.gasDampingRatio = 0;
  ball.material.rollingResistance = 0;
  return MakeBall(ball);
}

Blueprint MakeLosslessCube(double friction) {
  LatticeDefinition cube = DescribeCube(20000, friction);
  cube.cells = {2, 2, 2};
  cube.cellSize = 0.2;
  cube.rollingResistance = 0;
  return MakeLattice(cube);
}

ContactScene MakeBounceScene() {
  ContactScene scene{.name = "bounce", .blueprints = {MakeLosslessBall(2)}, .obstacles = {Obstacle{}}, .bodies = {}};
  scene.bodies.push_back(
      {.position = Vector3d(0, 0, 0.56), .velocity = Vector3d(1, 0, -2), .spin = Vector3d(1, -3, 2)});
  return scene;
}

// Comes to rest within the motion.
ContactScene MakeSlideScene() {
  ContactScene scene{.name = "slide", .blueprints = {MakeLosslessCube(0.3)}, .obstacles = {Obstacle{}}, .bodies = {}};
  scene.bodies.push_back(
      {.position = Vector3d(0, 0, 0.203), .velocity = Vector3d(1, 0.3, 0), .spin = Vector3d(0, 0, 1)});
  return scene;
}

ContactScene MakeStackScene() {
  ContactScene scene{.name = "stack", .blueprints = {MakeLosslessCube(0.6)}, .obstacles = {Obstacle{}}, .bodies = {}};
  for (int i = 0; i < 3; ++i) scene.bodies.push_back({.position = Vector3d(0.02 * i, 0.01 * i, 0.203 + 0.406 * i)});
  return scene;
}

// One ball presses another into a groove.
ContactScene MakeSqueezeScene() {
  ContactScene scene{.name = "squeeze", .blueprints = {MakeLosslessBall(2)}, .obstacles = {}, .bodies = {}};
  for (const double side : {1.0, -1.0}) {
    Obstacle wall;
    wall.normal = Vector3d(0.8 * side, 0, 0.6);
    wall.friction = 0.5;
    scene.obstacles.push_back(wall);
  }
  // 0.5 m from both walls: 0.6 z = 0.5.
  scene.bodies.push_back({.position = Vector3d(0, 0, 0.86), .velocity = Vector3d(0, 0, -1)});
  scene.bodies.push_back({.position = Vector3d(0.05, 0.03, 1.9), .velocity = Vector3d(0, 0, -3)});
  return scene;
}

ContactScene MakeClothScene() {
  ClothDefinition cloth;
  cloth.points = {13, 13};
  cloth.spacing = 0.1;
  cloth.orientation = Orientation::kHorizontal;
  cloth.material.drag = 0;
  cloth.material.rollingResistance = 0;
  ContactScene scene{.name = "cloth over ball",
                     .blueprints = {MakeLosslessBall(2), MakeCloth(cloth)},
                     .obstacles = {Obstacle{}},
                     .bodies = {}};
  scene.bodies.push_back({.position = Vector3d(0, 0, 0.505)});
  scene.bodies.push_back({.blueprint = 1, .position = Vector3d(0.03, 0.02, 1.05), .velocity = Vector3d(0, 0, -0.5)});
  return scene;
}

void AddPlaced(const ContactScene::Placed& placed, World& world) {
  const BodyId id = world.AddBody(placed.blueprint, placed.position);
  const std::vector<Vector3d> x = ReadPositions(world.ReadBody(id));
  std::vector<Vector3d> v;
  for (const Vector3d& p : x) v.emplace_back(placed.velocity + placed.spin.cross(p - placed.position));
  world.SetMotion(id, x, v);
}

}  // namespace

std::vector<ContactScene> MakeContactScenes() {
  return {MakeBounceScene(), MakeSlideScene(), MakeStackScene(), MakeSqueezeScene(), MakeClothScene()};
}

std::unique_ptr<World> MakeSceneWorld(const ContactScene& scene, const WorldSettings& settings, Integrator integrator,
                                      bool isPlain) {
  auto world = std::make_unique<World>(settings);
  for (Blueprint blueprint : scene.blueprints) {
    if (integrator != Integrator::kRungeKutta4) SetIntegrator(blueprint, integrator);
    if (isPlain) {  // CanGoInPack
      blueprint.singlePlan = {};
      blueprint.fullPlan = {};
      blueprint.singleGridPlan = {};
      blueprint.fullGridPlan = {};
    }
    world->AddBlueprint(std::move(blueprint));
  }
  for (const Obstacle& obstacle : scene.obstacles) world->AddObstacle(obstacle);
  for (const ContactScene::Placed& placed : scene.bodies) AddPlaced(placed, *world);
  return world;
}

std::vector<Vector3d> ReadAllPositions(const World& world) {
  std::vector<Vector3d> all;
  for (const Body& body : world.Bodies()) {
    VisitVertices(body, [&](std::size_t, const Vector3d& p) { all.push_back(p); });
  }
  return all;
}

double FindRms(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace wobble::bench
