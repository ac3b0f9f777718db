// Bullet's soft bodies, the usual off-the-shelf choice for a game: the same balls in the same world.
#pragma once

#include <memory>
#include <span>

#include "server/physics/contact/obstacle.h"
#include "server/physics/world.h"

namespace wobble::bench {

// Defaults are Bullet's own, except for `clusters`, which has no default in Bullet.
struct BulletSettings {
  enum class Contacts { kNone, kVertexFace, kClusters };  // between soft bodies
  Contacts contacts = Contacts::kNone;
  int clusters = 8;      // per body
  double margin = 0.25;  // contact margin around a body, m
};

// Everything that BulletSettings does not set is Bullet's default: one step per tick, one iteration of its position
// solver.
class BulletWorld {
 public:
  // Copies every body of `world` with its shape and motion, its gas as pressure and its obstacles as boxes, because
  // Bullet's soft bodies do not collide with its planes.
  BulletWorld(const physics::World& world, const BulletSettings& settings);
  ~BulletWorld();

  void Step();

 private:
  struct Bodies;
  std::unique_ptr<Bodies> m_bodies;
};

}  // namespace wobble::bench
