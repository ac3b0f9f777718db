// Bullet's soft bodies, the ones that a game would take from the shelf: the same balls in the same world.
#pragma once

#include <memory>
#include <span>

#include "server/physics/contact/obstacle.h"
#include "server/physics/world.h"

namespace wobble::bench {

// As Bullet has them, but for clusters, of which it has none.
struct BulletSettings {
  enum class Contacts { kNone, kVertexFace, kClusters };  // between soft bodies
  Contacts contacts = Contacts::kNone;
  int clusters = 8;      // of a body
  double margin = 0.25;  // about a body, within which it touches, m
};

// All but what is said in the settings as Bullet has it: one step a tick, one round of its position solver.
class BulletWorld {
 public:
  // Every body of `world` in its shape and motion, its gas as pressure, its obstacles as boxes: Bullet's soft bodies do
  // not meet its planes.
  BulletWorld(const physics::World& world, const BulletSettings& settings);
  ~BulletWorld();

  void Step();

 private:
  struct Bodies;
  std::unique_ptr<Bodies> m_bodies;
};

}  // namespace wobble::bench
