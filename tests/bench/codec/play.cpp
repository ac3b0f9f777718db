#include "tests/bench/codec/play.h"

#include "server/physics/shapes/ball.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kArena = 6;  // half of its side, m

}  // namespace

std::vector<Obstacle> MakeArena() {
  std::vector<Obstacle> arena(1);
  for (const Vector3d& side : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0)}) {
    Obstacle& wall = arena.emplace_back();
    wall.normal = side;
    wall.offset = -kArena;
    wall.friction = 0.2;
  }
  return arena;
}

Blueprint MakePlayedBall(double gas) {
  BallDefinition ball;
  ball.radius = 1;
  ball.material.mass = 0.25 * static_cast<double>(CountVertices(ball.subdivisions));
  ball.material.stiffness = 750;
  ball.material.dampingRatio = 0.3;
  ball.material.gas = gas;
  return MakeBall(ball);
}

Control Actor::Act(Pattern pattern, const World& world) {
  if (--m_ticksLeft <= 0) TurnElsewhere(pattern, world.Bodies().size());
  Control control;
  Vector3d way = m_way;
  if (m_hunts) {
    way = world.FindCentre(world.Bodies()[m_prey]) - world.FindCentre(world.Bodies()[m_self]);
    way.z() = 0;
  }
  if (way.norm() > 0) way.normalize();
  control.moveX = way.x();
  control.moveY = way.y();
  control.jump = m_random.Happens(pattern == Pattern::kChase ? 0.02 : 0.01);
  control.puff = m_puffs;
  return control;
}

void Actor::TurnElsewhere(Pattern pattern, std::size_t count) {
  m_ticksLeft = m_random.DrawWhole(15, 60);
  m_prey = (m_self + 1 + m_random.Choose(count - 1)) % count;
  m_way = m_random.DrawDirection();
  m_way.z() = 0;
  m_hunts = pattern == Pattern::kChase && m_random.Happens(0.3);
  m_puffs = pattern == Pattern::kRoam && m_random.Happens(0.2);
}

}  // namespace wobble::bench
