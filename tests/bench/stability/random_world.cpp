// Nothing is left out because bodies could not bear it: shells whose gas cannot carry the heap on them are crushed
// flat, and impacts fold lattices and shells through themselves.
#include "tests/bench/stability/random_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/bench/stability/random_bodies.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kGravity = 9.81;
constexpr std::size_t kMostBodies = 12;
constexpr double kMostSpeed = 15;  // of drops and kicks, m/s; a fall from four storeys

}  // namespace

RandomWorld::RandomWorld(std::uint64_t seed, std::uint32_t number) : m_random(seed * 1000003 + number) {
  WorldSettings settings;
  if (m_random.Happens(0.1)) settings.gravity.z() = -m_random.Draw(0, 25);
  if (m_random.Happens(0.2)) {
    const Vector3d direction = m_random.DrawDirection();
    settings.wind = m_random.Draw(0, 15) * direction;
  }
  m_world = std::make_unique<World>(settings);
  DrawBlueprints();
  DrawGround();
  PlaceBodies();
  AddDrives();
  const int kicks = m_random.DrawWhole(0, 6);
  for (int i = 0; i < kicks; ++i) m_kicks.push_back(m_random.DrawWhole(1, kRandomTicks));
  if (m_random.Happens(0.15)) {
    for (int i = 0; i < 3; ++i) m_tilts.push_back(m_random.DrawWhole(1, kRandomTicks));
  }
  for (const Body& body : m_world->Bodies()) {
    if (m_players.size() < 3 && m_random.Happens(0.25)) m_players.push_back({body.id, m_random.DrawWhole(1, 60)});
  }
}

// Few worlds are large, because large ones take most of the time.
void RandomWorld::DrawBlueprints() {
  constexpr double kFewest = 8;
  constexpr double kMost = 645;
  m_mostVertices = static_cast<std::size_t>(kFewest * std::pow(kMost / kFewest, std::pow(m_random.Draw(0, 1), 2)));
  const int count = m_random.DrawWhole(1, 3);
  for (int i = 0; i < count; ++i) {
    // Share of the world's vertices; the other blueprints get the rest.
    const double share = m_random.Happens(0.25) ? 1 : m_random.DrawMagnitude(0.08, 0.7);
    RandomBody body = DrawBody(m_random, static_cast<std::size_t>(share * static_cast<double>(m_mostVertices)));
    m_refused += body.refused;
    m_reach = std::max(m_reach, body.blueprint.reach);
    m_definitions.push_back(body.definition);
    m_descriptions.push_back(body.description);
    m_world->AddBlueprint(std::move(body.blueprint));
  }
}

void RandomWorld::DrawGround() {
  Obstacle ground;
  ground.friction = m_random.Draw(0.1, 1);
  const std::size_t lot = m_random.Choose(8);
  if (lot == 0) return AddTerrain();
  m_world->AddObstacle(ground);
  m_place = "plane";
  if (lot <= 2) return;
  if (lot <= 4) return AddSlopes();
  Obstacle thing;
  thing.friction = m_random.Draw(0.1, 1);
  thing.centre = m_random.DrawWithin({-0.5, -0.5, 0}, {0.5, 0.5, 0});
  if (lot == 5) {
    thing.kind = Obstacle::Kind::kBox;
    thing.halfExtents = m_random.DrawWithin({0.1, 0.1, 0.1}, {2, 2, 1});
    m_floor = thing.halfExtents.z() + 0.05;
    m_place = "box on a plane";
  } else if (lot == 6) {
    thing.kind = Obstacle::Kind::kSphere;
    thing.radius = m_random.Draw(0.1, 1.5);
    m_floor = thing.radius;
    m_place = "sphere on a plane";
  } else {
    thing.kind = Obstacle::Kind::kCapsule;
    const Vector3d direction = m_random.DrawDirection();
    thing.end = thing.centre + m_random.Draw(0.2, 3) * direction;
    thing.radius = m_random.Draw(0.1, 0.8);
    m_floor = std::max(0.0, thing.end.z()) + thing.radius;
    m_place = "capsule on a plane";
  }
  m_world->AddObstacle(thing);
}

// Two or four planes that slope down to a floor too small for the bodies that fall into it.
void RandomWorld::AddSlopes() {
  const double angle = m_random.Draw(0.3, 1.2);
  const double narrow = m_random.Draw(0, 2) * m_reach;
  const int sides = m_random.Happens(0.5) ? 2 : 4;
  const double friction = m_random.Draw(0.1, 1);
  for (int side = 0; side < sides; ++side) {
    const double sign = side % 2 == 0 ? 1 : -1;
    Obstacle slope;
    slope.normal = Vector3d(side < 2 ? sign : 0, side < 2 ? 0 : sign, 0) * std::sin(angle);
    slope.normal.z() = std::cos(angle);
    slope.normal.normalize();
    slope.offset = -narrow * std::sin(angle);
    slope.friction = friction;
    m_world->AddObstacle(slope);
  }
  m_place = sides == 2 ? "wedge" : "funnel";
}

// Hills in a bowl. What is kicked over its rim falls past it.
void RandomWorld::AddTerrain() {
  constexpr int kNodes = 32;
  const double cell = m_random.Draw(1, 2);
  const double hills = m_random.Draw(0, 0.4) * cell;
  std::vector<double> heights;
  for (int row = 0; row < kNodes; ++row) {
    for (int column = 0; column < kNodes; ++column) {
      const double x = column - (kNodes - 1) / 2.0;
      const double y = row - (kNodes - 1) / 2.0;
      heights.push_back(0.05 * cell * (x * x + y * y) / 2 + m_random.Draw(0, hills));
      m_floor = std::max(m_floor, std::hypot(x, y) < 4 ? heights.back() : 0);
    }
  }
  Obstacle ground;
  ground.kind = Obstacle::Kind::kHeightField;
  ground.friction = m_random.Draw(0.1, 1);
  ground.centre = Vector3d(-cell * (kNodes - 1) / 2, -cell * (kNodes - 1) / 2, 0);
  ground.field = MakeHeightField(kNodes, cell, heights);
  m_world->AddObstacle(ground);
  m_terrain = {.columns = kNodes, .cellSize = cell, .heights = std::move(heights)};
  m_place = "hills";
}

// Places a heap, several columns side by side, or one column: apart from each other, at heights from which they fall at
// up to the highest speed.
void RandomWorld::PlaceBodies() {
  const bool column = m_random.Happens(0.4);
  const double gravity = std::max(1.0, -m_world->Settings().gravity.z());
  const double drop = kMostSpeed * kMostSpeed * m_random.Draw(0, 1) / (2 * gravity);
  const double spacing = 2.1 * m_reach + 0.05;
  // On slopes, above the height at which bodies beside the middle meet them.
  const double base =
      m_floor + 1.2 * m_reach + 0.05 + std::min(drop, 12.0) + (m_world->Obstacles().size() > 2 ? 4 * m_reach : 0);
  std::size_t vertices = 0;
  const std::size_t most = m_random.Happens(0.3) ? 1 : static_cast<std::size_t>(m_random.DrawWhole(2, kMostBodies));
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t blueprint = i < m_world->Blueprints().size() ? i : m_random.Choose(m_world->Blueprints().size());
    vertices += m_world->Blueprints()[blueprint].rest.size();
    if (i > 0 && vertices > m_mostVertices) break;
    const double level = column ? static_cast<double>(i) : static_cast<double>(i / 4);
    Vector3d position(0, 0, base + spacing * level);
    if (!column)
      position += spacing * Vector3d(static_cast<double>(i % 2) - 0.5, static_cast<double>(i / 2 % 2) - 0.5, 0);
    const Vector3d aside = m_random.DrawWithin({-1, -1, 0}, {1, 1, 0});
    position += m_random.Draw(0, 0.2 * m_reach) * aside;
    Vector3d velocity = Vector3d::Zero();
    if (m_random.Happens(0.3)) {
      const Vector3d direction = m_random.DrawDirection();
      velocity = kMostSpeed * m_random.Draw(0, 0.7) * direction;
    }
    m_world->AddBody(static_cast<std::uint8_t>(blueprint), position, velocity);
  }
}

void RandomWorld::AddDrives() {
  for (const Body& body : m_world->Bodies()) {
    if (!m_random.Happens(0.1)) continue;
    const Blueprint& blueprint = m_world->BlueprintOf(body);
    Drive drive;
    drive.body = body.id;
    const Vector3d direction = m_random.DrawDirection();
    drive.force = m_random.Draw(0, 2) * kGravity * blueprint.totalMass * direction;
    drive.gasFactor = m_random.Happens(0.5) ? m_random.Draw(0.7, 1.6) : 1;
    drive.period = m_random.Draw(1, 5);
    drive.begin = 0;
    drive.end = drive.period * m_random.Draw(0.1, 0.5);
    for (std::size_t i = 0; i < blueprint.rest.size(); ++i) drive.vertices.push_back(static_cast<std::uint16_t>(i));
    m_world->AddDrive(drive);
  }
}

void RandomWorld::Act() {
  const int tick = static_cast<int>(m_world->Tick());
  for (const int due : m_kicks) {
    if (due == tick) Kick();
  }
  for (const int due : m_tilts) {
    if (due != tick) continue;
    const double gravity = m_world->Settings().gravity.norm();
    const double angle = m_random.Draw(0, 0.6);
    const double towards = m_random.Draw(0, 2 * std::numbers::pi);
    m_world->SetGravity(
        gravity * Vector3d(std::sin(angle) * std::cos(towards), std::sin(angle) * std::sin(towards), -std::cos(angle)));
  }
  for (Player& player : m_players) {
    if (player.nextTick == tick) Steer(player);
  }
}

// Kicks the whole body, spins it, or kicks the half that faces the impact.
void RandomWorld::Kick() {
  const Body& body = m_world->Bodies()[m_random.Choose(m_world->Bodies().size())];
  const Vector3d centre = m_world->FindCentre(body);
  const double speed = kMostSpeed * m_random.Draw(0, 1);
  const Vector3d direction = m_random.DrawDirection();
  const std::size_t lot = m_random.Choose(3);
  const double reach = m_world->BlueprintOf(body).reach;
  std::vector<Vector3d> positions;
  VisitVertices(body, [&](std::size_t, const Vector3d& p) { positions.push_back(p); });
  std::vector<Vector3d> velocities;
  std::visit(
      [&](const auto& state) {
        for (std::size_t i = 0; i < positions.size(); ++i) {
          const Vector3d way = positions[i] - centre;
          const Vector3d added = lot == 0   ? Vector3d(speed * direction)
                                 : lot == 1 ? Vector3d(speed / reach * direction.cross(way))
                                            : Vector3d((way.dot(direction) < 0 ? speed : 0) * direction);
          velocities.push_back(state.velocities[i].template cast<double>() + added);
        }
      },
      body.state);
  m_world->SetMotion(body.id, positions, velocities);
}

void RandomWorld::Steer(Player& player) {
  Control control;
  const double angle = m_random.Draw(0, 2 * std::numbers::pi);
  const double strength = m_random.Happens(0.3) ? 0 : 1;
  control.moveX = strength * std::cos(angle);
  control.moveY = strength * std::sin(angle);
  control.jump = m_random.Happens(0.3);
  control.puff = m_random.Happens(0.3);
  control.stiffen = m_random.Happens(0.3);
  m_world->SetControl(player.body, control, {});
  player.nextTick += m_random.DrawWhole(10, 90);
}

}  // namespace wobble::bench
