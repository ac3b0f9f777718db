// Which side a point of the world is on is asked at the end alone, and independently of the engine's contact:
//   floor, wall      by the sign of its height over them; a wall is a box 0.25 m thick that nothing gets round
//   terrain          by the height of the field there
//   sheet            by winding numbers. The sheet's frame is fixed in the plane z = 0; with the plane around it the
//                    sheet parts the world in two. A plane's winding number is ∓½ above and below it; that of the sheet
//                    in its place is the plane's, less that of the flat sheet, plus that of the sheet as it is. What
//                    slides off beside the frame and crosses the plane there has not gone through
//   body             by the order of their middles along the shot, if these came nearer than half of the radii and a
//                    vertex was deeper inside than half the smaller radius. Both have skins and meet head on: bodies
//                    that meet aside of their middles and do not bounce rightly slide past one another
//
// `contact --part tunnelling` shoots at most at 50 m/s, and only what can bear it; here nothing can.
#include "tests/bench/stress/shots.h"

#include <algorithm>
#include <cmath>

#include "server/physics/contact/height_field.h"
#include "server/physics/shapes/cloth.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/insides.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kLeastShotSpeed = 5;
constexpr double kMostShotSpeed = 100;
constexpr double kShotTime = 2;       // s
constexpr double kHalfSheet = 2;      // m
constexpr double kDeepBehind = 0.25;  // m; vertices of soft bodies are pressed into obstacles by less

class StressRange {
 public:
  StressRange(std::uint64_t seed, std::size_t number) : m_random(seed * 1000003 + number) {
    m_shot.target = kAllStressTargets[number % std::size(kAllStressTargets)];
    m_shot.speed = m_random.Draw(kLeastShotSpeed, kMostShotSpeed);
    WorldSettings settings;
    settings.gravity = Vector3d::Zero();
    m_world = std::make_unique<World>(settings);
  }

  StressShot Play() {
    m_shot.body = DrawKind();
    const Blueprint thrown = MakeStressBody(m_shot.body, m_random.DrawMagnitude(0.3, 3));
    m_world->AddBlueprint(thrown);
    if (m_shot.target == StressTarget::kBody) {
      AimAtStressBody(thrown);
    } else {
      AimDown(thrown);
    }
    const double duration = kShotTime + 2 / m_shot.speed;
    if (m_shot.target == StressTarget::kBody) {
      for (double gone = 0; gone < duration; gone += kContactTick) {
        PlayStress(*m_world, kContactTick, m_shot.outcome);
        WatchBodies();
      }
      JudgeBodies();
    } else {
      m_centre = m_world->FindCentre(m_world->Bodies()[0]);
      for (double gone = 0; gone < duration; gone += kContactTick) {
        PlayStress(*m_world, kContactTick, m_shot.outcome);
        WatchFrame();
      }
      Judge();
    }
    NoteInverted(*m_world, m_shot.outcome);
    return m_shot;
  }

 private:
  // Planar bodies meet planes alone. What is thin may rightly slip past another body.
  StressBody DrawKind() {
    for (;;) {
      const StressBody kind = kAllStressBodies[m_random.Choose(std::size(kAllStressBodies))];
      if (kind == StressBody::kRing && m_shot.target != StressTarget::kFloor) continue;
      if (kind >= StressBody::kCloth && m_shot.target == StressTarget::kBody) continue;
      if (kind == StressBody::kCloth && m_shot.target == StressTarget::kSheet) continue;
      return kind;
    }
  }

  // Onto a target that lies across the z axis; at sheets from either side.
  void AimDown(const Blueprint& thrown) {
    AddTarget();
    m_sign = m_shot.target == StressTarget::kSheet && m_random.Happens(0.5) ? -1 : 1;
    Vector3d aside = m_random.DrawDirection();
    if (thrown.full.planar) aside.y() = 0;
    const Vector3d direction = (Vector3d(0, 0, -1) + 0.5 * m_random.Draw(0, 1) * aside).normalized();
    const double across = thrown.full.planar ? 0 : 0.6;
    const Vector3d from = m_random.DrawWithin({-0.6, -across, 0}, {0.6, across, 0});
    const double height = m_ceiling + thrown.reach + m_random.Draw(0.05, 0.9);
    const Vector3d start = from - height / std::fabs(direction.z()) * direction;
    m_world->AddBody(0, Vector3d(start.x(), start.y(), m_sign * start.z()),
                     m_shot.speed * Vector3d(direction.x(), direction.y(), m_sign * direction.z()));
    if (m_shot.target == StressTarget::kSheet) m_world->AddBody(1, Vector3d::Zero());
  }

  void AddTarget() {
    Obstacle obstacle;
    if (m_shot.target == StressTarget::kWall) {
      obstacle.kind = Obstacle::Kind::kBox;
      obstacle.halfExtents = Vector3d(200, 200, 0.125);
      obstacle.centre = Vector3d(0, 0, -0.125);
    } else if (m_shot.target == StressTarget::kTerrain) {
      constexpr int kNodes = 40;
      std::vector<double> heights;
      for (int i = 0; i < kNodes * kNodes; ++i) heights.push_back(m_random.Draw(0, 0.5));
      obstacle.kind = Obstacle::Kind::kHeightField;
      obstacle.field = MakeHeightField(kNodes, 1, heights);
      obstacle.centre = Vector3d(-20, -20, 0);
      m_ceiling = 0.7;
    } else if (m_shot.target == StressTarget::kSheet) {
      ClothDefinition sheet{.points = {21, 21}, .orientation = Orientation::kHorizontal, .pinned = Pinned::kFrame};
      sheet.spacing = 0.2;
      sheet.material.mass = m_random.Draw(5, 40);
      sheet.material.stiffness = m_random.DrawMagnitude(500, 4000);
      sheet.bendStiffness = m_random.Happens(0.5) ? 0 : m_random.Draw(0, 2);
      m_world->AddBlueprint(MakeCloth(sheet));
      return;
    }
    m_world->AddObstacle(obstacle);
  }

  void AimAtStressBody(const Blueprint& thrown) {
    m_shot.other = DrawKind();
    const Blueprint other = MakeStressBody(m_shot.other, m_random.DrawMagnitude(0.3, 3));
    m_world->AddBlueprint(other);
    m_direction = m_random.DrawDirection();
    m_radii = thrown.size + other.size;
    const Vector3d across = m_random.Draw(0, 0.02) * m_radii * m_direction.unitOrthogonal();
    const double apart = thrown.reach + other.reach + m_random.Draw(0.05, 0.9);
    m_nearest = apart;
    m_world->AddBody(0, -apart * m_direction + across, m_shot.speed / 2 * m_direction);
    m_world->AddBody(1, Vector3d::Zero(), -m_shot.speed / 2 * m_direction);
  }

  // Height over the target on the side that the shot came from, m; of a sheet ±1.
  double FindHeightOver(const Vector3d& p) const {
    if (m_shot.target == StressTarget::kTerrain) {
      const Obstacle& ground = m_world->Obstacles()[0];
      return p.z() - ground.centre.z() -
             FindHeight(*ground.field, p.x() - ground.centre.x(), p.y() - ground.centre.y());
    }
    if (m_shot.target != StressTarget::kSheet) return p.z();
    const Body& sheet = m_world->Bodies()[1];
    const Blueprint& blueprint = m_world->BlueprintOf(sheet);
    const double turns = FindWinding(blueprint.full.faces, ReadPositions(sheet), p) -
                         FindWinding(blueprint.full.faces, blueprint.rest, p) + (p.z() > 0 ? -0.5 : 0.5);
    return turns * m_sign < 0 ? 1 : -1;
  }

  // Notes where the middle has crossed the plane of the sheet's frame last.
  void WatchFrame() {
    if (m_shot.target != StressTarget::kSheet) return;
    const Vector3d centre = m_world->FindCentre(m_world->Bodies()[0]);
    if ((centre.z() > 0) != (m_centre.z() > 0)) m_isBesideFrame = centre.head<2>().cwiseAbs().maxCoeff() > kHalfSheet;
    m_centre = centre;
  }

  void Judge() {
    const double deep = m_shot.target == StressTarget::kSheet ? 0 : kDeepBehind;
    const std::vector<Vector3d> x = ReadPositions(m_world->Bodies()[0]);
    const auto isBehind = [&](const Vector3d& p) { return !(FindHeightOver(p) >= -deep); };
    m_shot.behind = static_cast<double>(std::ranges::count_if(x, isBehind)) / static_cast<double>(x.size());
    const bool isMiddle = !(FindHeightOver(m_world->FindCentre(m_world->Bodies()[0])) >= 0);
    m_shot.through = (isMiddle || m_shot.behind >= 0.5) && !m_isBesideFrame;
    m_shot.hangs = !m_shot.through && !m_isBesideFrame && m_shot.behind > 0;
    m_shot.outcome.through = m_shot.through ? 1 : 0;
  }

  void WatchBodies() {
    const Body& thrown = m_world->Bodies()[0];
    const Body& other = m_world->Bodies()[1];
    m_nearest = std::min(m_nearest, (m_world->FindCentre(thrown) - m_world->FindCentre(other)).norm());
    m_deepest = std::max({m_deepest, FindDeepestOf(thrown, other), FindDeepestOf(other, thrown)});
  }

  void JudgeBodies() {
    const Body& thrown = m_world->Bodies()[0];
    const Body& other = m_world->Bodies()[1];
    const double deep = 0.5 * std::min(m_world->BlueprintOf(thrown).size, m_world->BlueprintOf(other).size);
    const bool isPast = (m_world->FindCentre(other) - m_world->FindCentre(thrown)).dot(m_direction) < 0;
    m_shot.through = isPast && m_nearest < m_radii / 2 && m_deepest > deep;
    m_shot.hangs = !m_shot.through && std::max(FindDeepestOf(thrown, other), FindDeepestOf(other, thrown)) > deep;
    m_shot.outcome.through = m_shot.through ? 1 : 0;
  }

  double FindDeepestOf(const Body& ofVertices, const Body& ofFaces) const {
    const std::vector<Face>& faces = m_world->BlueprintOf(ofFaces).full.faces;
    if (faces.empty()) return 0;
    return FindDeepestInside(ReadPositions(ofVertices), faces, ReadPositions(ofFaces));
  }

  Random m_random;
  StressShot m_shot;
  std::unique_ptr<World> m_world;
  Vector3d m_direction = Vector3d::Zero();
  double m_radii = 0;                    // of both bodies, m
  double m_nearest = 0;                  // that the middles have come, m
  double m_deepest = 0;                  // that a vertex has been inside the other, m
  double m_ceiling = 0;                  // of the target, m
  double m_sign = 1;                     // -1: the shot comes from below
  Vector3d m_centre = Vector3d::Zero();  // of the body shot at a sheet, m
  bool m_isBesideFrame = false;          // the middle has crossed the frame's plane outside of it last
};

}  // namespace

const char* NameStressTarget(StressTarget target) {
  constexpr const char* kNames[] = {"floor", "wall", "terrain", "body", "sheet"};
  return kNames[static_cast<std::size_t>(target)];
}

StressShot PlayStressShot(std::uint64_t seed, std::size_t number) { return StressRange(seed, number).Play(); }

}  // namespace wobble::bench
