// Uses Bullet as its demos do: btSoftRigidDynamicsWorld, a link per spring, a face per face, pressure for the gas (its
// kPR is our nRT: both push a face with kPR/V times its area). This is the only file that includes Bullet.
#include "tests/bench/throughput/bullet.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cassert>
#include <vector>

#include "tests/bench/contact/bodies.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr float kReach = 100;  // half the side of a box that stands for a plane, m

btVector3 Convert(const Vector3d& from) {
  return {static_cast<btScalar>(from.x()), static_cast<btScalar>(from.y()), static_cast<btScalar>(from.z())};
}

int FindFlags(BulletSettings::Contacts contacts) {
  using Flags = btSoftBody::fCollision;
  switch (contacts) {
    case BulletSettings::Contacts::kNone:
      return Flags::SDF_RS;
    case BulletSettings::Contacts::kVertexFace:
      return Flags::SDF_RS | Flags::VF_SS;
    case BulletSettings::Contacts::kClusters:
      return Flags::SDF_RS | Flags::CL_SS;
  }
  return Flags::SDF_RS;
}

}  // namespace

struct BulletWorld::Bodies {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btBoxShape box{btVector3(kReach, kReach, kReach)};
  std::vector<std::unique_ptr<btRigidBody>> rigid;
  std::vector<std::unique_ptr<btSoftBody>> soft;
  double tick = 1.0 / 60;

  ~Bodies() {
    for (const auto& each : soft) world.removeSoftBody(each.get());
    for (const auto& each : rigid) world.removeRigidBody(each.get());
  }

  void AddPlane(const Obstacle& plane) {
    assert(plane.kind == Obstacle::Kind::kPlane);
    const btVector3 normal = Convert(plane.normal.normalized());
    const btTransform place(shortestArcQuat(btVector3(0, 0, 1), normal),
                            normal * (static_cast<btScalar>(plane.offset) - kReach));
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, &box);
    info.m_startWorldTransform = place;
    rigid.push_back(std::make_unique<btRigidBody>(info));
    world.addRigidBody(rigid.back().get());
  }

  void AddBody(const Blueprint& blueprint, const std::vector<Vector3d>& x, const std::vector<Vector3d>& v,
               const BulletSettings& settings) {
    const Coefficients<double>& full = blueprint.full;
    std::vector<btVector3> rest;
    std::vector<btScalar> masses;
    for (const Vector3d& each : blueprint.rest) rest.push_back(Convert(each));
    for (const double mass : full.masses) masses.push_back(static_cast<btScalar>(mass));
    auto body =
        std::make_unique<btSoftBody>(&world.getWorldInfo(), static_cast<int>(rest.size()), rest.data(), masses.data());
    // Add links in the rest shape, because their lengths are taken from it.
    for (const auto& spring : full.springs) body->appendLink(static_cast<int>(spring.a), static_cast<int>(spring.b));
    for (const Face& face : full.faces) body->appendFace(face[0], face[1], face[2]);
    if (settings.contacts == BulletSettings::Contacts::kClusters) body->generateClusters(settings.clusters);
    body->m_cfg.kPR = static_cast<btScalar>(full.gas);
    body->m_cfg.collisions = FindFlags(settings.contacts);
    body->getCollisionShape()->setMargin(static_cast<btScalar>(settings.margin));
    for (int i = 0; i < body->m_nodes.size(); ++i) {
      btSoftBody::Node& node = body->m_nodes[i];
      node.m_x = node.m_q = Convert(x[static_cast<std::size_t>(i)]);
      node.m_v = Convert(v[static_cast<std::size_t>(i)]);
    }
    body->updateBounds();
    world.addSoftBody(body.get());
    soft.push_back(std::move(body));
  }
};

BulletWorld::BulletWorld(const World& world, const BulletSettings& settings)
    : m_bodies(std::make_unique<Bodies>()), m_stepsATick(settings.stepsATick) {
  const btVector3 gravity = Convert(world.Settings().gravity);
  m_bodies->tick = world.Settings().tickDuration;
  m_bodies->world.setGravity(gravity);
  m_bodies->world.getWorldInfo().m_gravity = gravity;
  m_bodies->world.getWorldInfo().m_sparsesdf.Initialize();
  for (const Obstacle& obstacle : world.Obstacles()) m_bodies->AddPlane(obstacle);
  for (const Body& body : world.Bodies()) {
    m_bodies->AddBody(world.BlueprintOf(body), ReadPositions(body), ReadVelocities(body), settings);
  }
}

BulletWorld::~BulletWorld() = default;

void BulletWorld::Step() {
  const double step = m_bodies->tick / m_stepsATick;
  for (int i = 0; i < m_stepsATick; ++i) m_bodies->world.stepSimulation(static_cast<btScalar>(step), 0);
}

std::vector<Vector3d> BulletWorld::ListPositions() const {
  std::vector<Vector3d> positions;
  for (const auto& body : m_bodies->soft) {
    for (int i = 0; i < body->m_nodes.size(); ++i) {
      const btVector3& x = body->m_nodes[i].m_x;
      positions.emplace_back(double{x.x()}, double{x.y()}, double{x.z()});
    }
  }
  return positions;
}

}  // namespace wobble::bench
