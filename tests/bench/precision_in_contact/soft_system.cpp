// Contacts between bodies are searched for by brute force, once a tick: for every vertex near another body its nearest
// vertex there, and from that the engine's walk over faces.
#include "tests/bench/precision_in_contact/soft_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/model/survey.h"
#include "server/physics/skins/body_contact_update.h"
#include "server/physics/skins/body_contact_view.h"
#include "tests/bench/contact/bodies.h"

namespace wobble::bench {

using namespace physics;

namespace {

// How far from a face a vertex is listed, beside the way that it goes in the tick, m.
constexpr double kListMargin = 0.03;
// Substeps that a tick is taken to have where contacts are armed at its beginning.
constexpr double kSubstepsToArm = 4;

struct Sphere {
  Vector3d centre = Vector3d::Zero();
  double radius = 0;
};

Sphere FindSphere(std::span<const Vector3d> x) {
  Sphere sphere;
  for (const Vector3d& p : x) sphere.centre += p / static_cast<double>(x.size());
  for (const Vector3d& p : x) sphere.radius = std::max(sphere.radius, (p - sphere.centre).norm());
  return sphere;
}

double FindTopSpeed(std::span<const Vector3d> v) {
  double square = 0;
  for (const Vector3d& each : v) square = std::max(square, each.squaredNorm());
  return std::sqrt(square);
}

// The vertex of the skin that is nearest to p.
std::uint16_t FindNearestVertex(const Topology& topology, const VectorView<double>& x, const Vector3d& p) {
  std::uint16_t nearest = topology.vertices[0];
  double least = std::numeric_limits<double>::max();
  for (const std::uint16_t vertex : topology.vertices) {
    const double square = (x[vertex] - p).squaredNorm();
    if (square >= least) continue;
    least = square;
    nearest = vertex;
  }
  return nearest;
}

// Where the vertex of a contact is to the face that it is followed to within a substep.
FacePoint<double> FindPresentPoint(const Meeting<double>& meeting, const BodyContact<double>& contact) {
  const Skin<double> skin = SkinFrom(meeting, contact.side);
  const Vector3d& p = meeting.x[contact.vertex];
  FacePoint<double> at = FollowFace(skin, contact.face, p);
  if (at.face != contact.face) {
    const FacePoint<double> kept = FindFacePoint(skin, contact.face, p);
    if (HangsOn(contact, at, kept)) at = kept;
  }
  FadeGap(skin, at);
  at.distance += contact.leap;
  return at;
}

}  // namespace

SoftSystem::SoftSystem(const World& world) : m_gravity(world.Settings().gravity) {
  for (const Obstacle& obstacle : world.Obstacles()) {
    m_surfaces.push_back(MakeSurface<double>(obstacle, Vector3d::Zero()));
  }
  for (const Body& body : world.Bodies()) {
    const Blueprint& blueprint = world.BlueprintOf(body);
    const std::vector<Vector3d> positions = ReadPositions(body);
    const std::vector<Vector3d> velocities = ReadVelocities(body);
    m_bodies.push_back(
        {.blueprint = &blueprint, .begin = x.size(), .end = x.size() + positions.size(), .contacts = {}});
    x.insert(x.end(), positions.begin(), positions.end());
    v.insert(v.end(), velocities.begin(), velocities.end());
    inverseMasses.insert(inverseMasses.end(), blueprint.full.inverseMasses.begin(), blueprint.full.inverseMasses.end());
  }
  before = x;
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < m_bodies.size(); ++j) {
      const Coefficients<double>& one = m_bodies[i].blueprint->full;
      const Coefficients<double>& other = m_bodies[j].blueprint->full;
      if (one.faces.empty() || other.faces.empty()) continue;
      m_pairs.push_back({.bodies = {i, j}, .law = Combine<double>(one.contact, other.contact), .sides = {}});
    }
  }
}

std::span<const Vector3d> SoftSystem::Positions(const OneBody& body) const {
  return std::span(x).subspan(body.begin, body.end - body.begin);
}

std::span<const Vector3d> SoftSystem::Velocities(const OneBody& body) const {
  return std::span(v).subspan(body.begin, body.end - body.begin);
}

Meeting<double> SoftSystem::MakeMeeting(const Pair& pair, std::size_t side) const {
  const OneBody& own = m_bodies[pair.bodies[side]];
  const OneBody& other = m_bodies[pair.bodies[1 - side]];
  return {.x = Positions(own),
          .v = Velocities(own),
          .shares = own.blueprint->full.contactShares,
          .skin = {.faces = other.blueprint->full.faces,
                   .topology = &other.blueprint->topology,
                   .x = Positions(other),
                   .offset = own.blueprint->rodRadius + pair.gap,
                   .fadingGap = FindFadingGap(*own.blueprint, *other.blueprint, pair.gap)},
          .skinV = Velocities(other)};
}

void SoftSystem::BeginTick(double duration) {
  std::vector<Contact<double>> scratch;
  for (OneBody& body : m_bodies) {
    const Coefficients<double>& full = body.blueprint->full;
    FindContacts<double>({.surfaces = m_surfaces,
                          .x = Positions(body),
                          .v = Velocities(body),
                          .survey = MakeSurvey<double>(full.masses, Positions(body), Velocities(body)),
                          .range = full.contact.range,
                          .duration = duration},
                         body.contacts, scratch);
  }
  for (Pair& pair : m_pairs) ListPair(duration, pair);
}

void SoftSystem::ListPair(double duration, Pair& pair) const {
  const double fullGap = FindFullGap(*m_bodies[pair.bodies[0]].blueprint, *m_bodies[pair.bodies[1]].blueprint);
  FindWithGap(fullGap, duration, pair.gap, pair.sides, [&](std::size_t side) { ListSide(duration, side, pair); });
}

void SoftSystem::ListSide(double duration, std::size_t side, Pair& pair) const {
  const Meeting<double> meeting = MakeMeeting(pair, side);
  const OneBody& own = m_bodies[pair.bodies[side]];
  const OneBody& other = m_bodies[pair.bodies[1 - side]];
  std::vector<BodyContact<double>>& contacts = pair.sides[side];
  const Topology& ownTopology = own.blueprint->topology;
  const Topology& topology = other.blueprint->topology;
  const bool bothClosed = !topology.isOpen && !ownTopology.isOpen;
  const Skin<double> ownSkin{.faces = own.blueprint->full.faces, .topology = &ownTopology, .x = Positions(own)};
  const double speed = FindTopSpeed(Velocities(own)) + FindTopSpeed(Velocities(other));
  const double reach = kListMargin + kLargestGap + duration * speed;
  const Sphere sphere = FindSphere(Positions(other));
  std::vector<BodyContact<double>> listed;
  auto kept = contacts.begin();
  for (const std::uint16_t vertex : ownTopology.vertices) {
    while (kept != contacts.end() && kept->vertex < vertex) ++kept;
    const bool known = kept != contacts.end() && kept->vertex == vertex;
    const Vector3d& p = meeting.x[vertex];
    if (!known && (p - sphere.centre).norm() > sphere.radius + meeting.skin.offset + reach) continue;
    BodyContact<double> contact = known ? *kept : BodyContact<double>{.vertex = vertex};
    if (bothClosed) contact.outward = FindOutward(ownSkin, vertex);
    FacePoint<double> at;
    if (known) {
      at = RecallContact(pair.law, meeting, p, contact);
    } else {
      const FacePoint<double> around = FindFaceAround(meeting.skin, FindNearestVertex(topology, meeting.skin.x, p), p);
      at = FindNearestFace(meeting.skin, around, p);
      at = ChooseSide(meeting, at, p, contact.outward, contact.side);
    }
    if (at.distance > reach) continue;
    if (!known) FadeGap(meeting.skin, at);
    Arm(pair.law, FindRelativeVelocity(meeting, vertex, at), duration / kSubstepsToArm, meeting.skin, at, contact);
    if (!known) contact.depth = -at.distance;
    contact.face = at.face;
    contact.foot = at.weights;
    listed.push_back(contact);
  }
  contacts = std::move(listed);
}

void SoftSystem::EndSubstep(double h) {
  for (OneBody& body : m_bodies) {
    UpdateAnchors<double>(body.blueprint->full.contact, m_surfaces, body.contacts, h, Positions(body),
                          Velocities(body));
  }
  for (Pair& pair : m_pairs) {
    for (const std::size_t side : {0U, 1U})
      UpdateBodyContacts<double>(pair.law, MakeMeeting(pair, side), h, pair.sides[side]);
  }
}

void SoftSystem::FindTouches(std::vector<Touch>& touches) const {
  touches.clear();
  for (const OneBody& body : m_bodies) AddPlaneTouches(body, touches);
  for (const Pair& pair : m_pairs) {
    for (const std::size_t side : {0U, 1U}) AddBodyTouches(pair, side, touches);
  }
}

void SoftSystem::AddPlaneTouches(const OneBody& body, std::vector<Touch>& touches) const {
  const Coefficients<double>& full = body.blueprint->full;
  for (const Contact<double>& contact : body.contacts) {
    const Surface<double>& surface = m_surfaces[contact.surface];
    const std::size_t point = body.begin + contact.vertex;
    if (!(surface.normal.dot(x[point]) < surface.offset)) continue;
    Touch touch;
    touch.points[0] = static_cast<std::uint32_t>(point);
    touch.weights[0] = 1;
    touch.normal = surface.normal;
    touch.constant = surface.offset;
    touch.law = &full.contact;
    touch.friction = full.contact.friction * surface.friction;
    touch.share = full.contactShares[contact.vertex];
    touch.sticks = contact.touching;
    if (contact.touching) touch.slip = before[point] - contact.anchor;
    touches.push_back(touch);
  }
}

void SoftSystem::AddBodyTouches(const Pair& pair, std::size_t side, std::vector<Touch>& touches) const {
  const Meeting<double> meeting = MakeMeeting(pair, side);
  const OneBody& other = m_bodies[pair.bodies[1 - side]];
  for (const BodyContact<double>& contact : pair.sides[side]) {
    if (contact.phase == ContactPhase::kWaiting) continue;
    const FacePoint<double> at = FindPresentPoint(meeting, contact);
    if (!Pushes(contact, at)) continue;
    Touch touch;
    touch.count = 4;
    touch.points[0] = static_cast<std::uint32_t>(m_bodies[pair.bodies[side]].begin + contact.vertex);
    touch.weights[0] = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      touch.points[i + 1] = static_cast<std::uint32_t>(other.begin + meeting.skin.faces[at.face][i]);
      touch.weights[i + 1] = -at.weights[static_cast<Eigen::Index>(i)];
    }
    touch.normal = at.normal;
    touch.constant = meeting.skin.offset - at.faded - contact.leap;
    touch.law = &pair.law;
    touch.friction = pair.law.friction;
    touch.share = meeting.shares[contact.vertex];
    touch.sticks = contact.phase == ContactPhase::kTouching;
    touch.slip = contact.slip;
    touches.push_back(touch);
  }
}

TouchForce SoftSystem::FindForce(const Touch& touch, double h) const {
  Vector3d place = Vector3d::Zero();
  Vector3d motion = Vector3d::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(touch.count); ++i) {
    place += touch.weights[i] * x[touch.points[i]];
    motion += touch.weights[i] * (x[touch.points[i]] - before[touch.points[i]]);
  }
  TouchForce force;
  const double depth = touch.constant - touch.normal.dot(place);
  if (!(depth > 0)) return force;
  const ContactParameters<double>& law = *touch.law;
  const double normal = ComputeNormalForce(law, depth, -touch.normal.dot(motion) / h);
  if (!(normal > 0)) return force;
  Vector3d pull = law.stickDamping / h * RemoveNormalPart<double>(motion, touch.normal);
  double stiffness = law.stickDamping / h;
  if (touch.sticks) {
    const Vector3d slip = RemoveNormalPart<double>(touch.slip + motion, touch.normal);
    pull += FindStickPull<double>(law, touch.friction, depth, slip);
    stiffness += law.stickStiffness;
  }
  const double limit = touch.friction * normal;
  const double strength = pull.norm();
  const double kept = strength > limit ? limit / strength : 1;
  force.normal = touch.share * normal;
  force.normalSlope =
      touch.share * (ComputePenaltySlope(law, depth) + law.damping * ComputeDampingShare(law, depth) / h);
  force.pull = touch.share * kept * pull;
  force.pullSlope = touch.share * kept * stiffness;
  return force;
}

}  // namespace wobble::bench
