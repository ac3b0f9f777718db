// Bullet's soft bodies, the usual off-the-shelf choice for a game: the same balls in the same world.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/physics/contact/obstacle.h"
#include "server/physics/world.h"

namespace wobble::bench {

// Defaults are Bullet's own, except for `clusters`, which has no default in Bullet.
struct BulletSettings {
  enum class Contacts { kNone, kVertexFace, kClusters };  // between soft bodies
  Contacts contacts = Contacts::kNone;
  int clusters = 8;      // per body
  double margin = 0.25;  // contact margin around a body, m
  int stepsATick = 1;
};

// Everything that BulletSettings does not set is Bullet's default: one iteration of its position solver a step.
class BulletWorld {
 public:
  // Copies every body of `world` with its shape and motion, its gas as pressure and its obstacles as boxes, because
  // Bullet's soft bodies do not collide with its planes.
  BulletWorld(const physics::World& world, const BulletSettings& settings);
  ~BulletWorld();

  void Step();
  // Of all vertices, body after body, m.
  [[nodiscard]] std::vector<physics::Vector3d> ListPositions() const;

 private:
  struct Bodies;
  std::unique_ptr<Bodies> m_bodies;
  int m_stepsATick;
};

}  // namespace wobble::bench
