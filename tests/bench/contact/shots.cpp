// Tunnelling. Bodies are shot at each other, at a plane, at a wall and at a sheet of cloth, at 5 to 50 m/s relative to
// the target, from any direction and at any offset that still hits, in single precision with the server's own ticks and
// substeps, because that is what players get.
//
// A shot has passed through if at its end
//   - a vertex of one body lies deep in the other (inside it even when it is shrunk to kDeep about its middle), or the
//     bodies have exchanged sides along the line of the shot, their centres came nearer than half the sum of the radii,
//     and a vertex was deeper inside than half the smaller radius; the last two conditions exclude bodies that graze or
//     roll over one another;
//   - for a plane or wall: the centre, or a vertex by more than kBehind, is behind it;
//   - for a sheet: the centre, or more than a twentieth of the vertices by more than a quarter of the body's radius, is
//     behind it: the solid angle of the sheet as seen from there has jumped by a whole turn (a path around the edge
//     changes it steadily). With fewer vertices behind it the body is snagged: it has not passed, but hangs in the
//     cloth.
//
// Firm bodies can bear the shot: the impact energy is at most nRT of a ball's gas, the speed at most a third of √(E/ρ)
// of a lattice. Softer bodies fold or turn inside out whatever the contact does; they are shot as well and counted
// separately.
//
// Ghosts prove that the criteria detect tunnelling: the same shots with contacts a million times softer.
#include "tests/bench/contact/shots.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/contact/insides.h"
#include "tests/bench/random.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kAfterMeeting = 0.4;  // s of play after the bodies should have met
constexpr double kDeep = 0.8;
constexpr double kDeepShare = 0.5;     // of the smaller radius
constexpr double kBehindShare = 0.25;  // of the radius
constexpr double kBehind = 0.25;       // m
constexpr double kLeastSpeed = 5;
constexpr double kMostSpeed = 50;
constexpr double kGhost = 1e-6;  // factor on the contact stiffness

struct Thrown {
  std::string name;
  Blueprint blueprint;
};

// Draws a material between the default, or the softest that bears the shot, and the stiffest that 64 substeps can hold
// at these speeds.
Thrown DrawBody(Random& random, double speed, bool firm, double contactShare) {
  constexpr double kHardest = 100;  // times the default ball
  constexpr double kSoftest = 1e4;  // Pa
  constexpr double kStiffest = 1e6;
  Thrown thrown;
  char name[64];
  if (random.Choose(3) > 0) {
    const int subdivisions = 1 + static_cast<int>(random.Choose(3));
    const Material standard = DescribeBall(subdivisions).material;
    const double bearing = std::clamp(standard.mass * speed * speed / 2 / standard.gas, 1.0, kHardest);
    const double ratio = firm ? random.DrawMagnitude(bearing, kHardest) : random.DrawMagnitude(1, bearing);
    BallDefinition ball = DescribeHardBall(subdivisions, ratio);
    ball.material.contactStiffness = contactShare * kContactStiffnessRatio * ball.material.stiffness;
    std::snprintf(name, sizeof name, "ball of %zu, k %.0f N/m", CountVertices(subdivisions), ball.material.stiffness);
    thrown = {name, MakeBall(ball)};
  } else {
    LatticeDefinition lattice = DescribeCube(kSoftest, 0.8);
    const double bearing = std::clamp(9 * lattice.density * speed * speed, kSoftest, kStiffest);
    lattice.youngModulus = firm ? random.DrawMagnitude(bearing, kStiffest) : random.DrawMagnitude(kSoftest, bearing);
    const int cells = 2 + static_cast<int>(random.Choose(3));
    lattice.cells = {cells, cells, cells};
    lattice.cellSize = 0.75 / cells;
    lattice.contactStiffness = contactShare * kContactStiffnessRatio * lattice.youngModulus * lattice.cellSize / 2.5;
    std::snprintf(name, sizeof name, "cube of %d cells, E %.0f Pa", cells, lattice.youngModulus);
    thrown = {name, MakeLattice(lattice)};
  }
  return thrown;
}

// Draws a point in the disc perpendicular to `direction`.
Vector3d DrawAcross(Random& random, const Vector3d& direction, double radius) {
  const Vector3d first = direction.unitOrthogonal();
  const double angle = random.Draw(0, 2 * std::numbers::pi);
  return radius * std::sqrt(random.Draw(0, 1)) * (std::cos(angle) * first + std::sin(angle) * direction.cross(first));
}

class Trial {
 public:
  Trial(std::uint64_t seed, ShotTarget target, bool firm, double contactShare)
      : m_random(seed), m_firm(firm), m_share(contactShare) {
    m_shot.target = target;
    m_shot.speed = m_random.Draw(kLeastSpeed, kMostSpeed);
    WorldSettings settings;
    settings.gravity = Vector3d::Zero();
    m_world = std::make_unique<World>(settings);
  }

  Shot Play() {
    const Thrown thrown = DrawBody(m_random, m_shot.speed, m_firm, m_share);
    m_shot.bodies = thrown.name;
    m_radius = thrown.blueprint.reach;
    m_gap = m_random.Draw(0.05, 0.9);
    switch (m_shot.target) {
      case ShotTarget::kBody:
        AimAtBody(thrown);
        break;
      case ShotTarget::kPlane:
      case ShotTarget::kWall:
        AimAtWall(thrown);
        break;
      case ShotTarget::kSheet:
        AimAtSheet(thrown);
        break;
    }
    const int ticks = static_cast<int>(std::ceil((m_gap / m_shot.speed + kAfterMeeting) / kContactTick));
    for (int tick = 0; tick < ticks; ++tick) {
      const StepReport report = m_world->Step();
      m_shot.nonFinite += report.nonFinite;
      m_shot.inverted += report.inverted;
      m_shot.mostSubsteps = std::max(m_shot.mostSubsteps, static_cast<double>(report.substeps) / report.awake);
      Watch();
    }
    m_shot.through = HasGoneThrough();
    return m_shot;
  }

 private:
  const Body& Thrower() const { return m_world->Bodies()[0]; }
  const Body& Target() const { return m_world->Bodies()[1]; }

  void AimAtBody(const Thrown& thrown) {
    const Thrown other = DrawBody(m_random, m_shot.speed, m_firm, m_share);
    m_shot.bodies += " at " + other.name;
    m_direction = m_random.DrawDirection();
    m_sumOfRadii = thrown.blueprint.size + other.blueprint.size;
    const Vector3d across = DrawAcross(m_random, m_direction, 0.8 * m_sumOfRadii);
    const double apart = thrown.blueprint.reach + other.blueprint.reach + m_gap;
    m_world->AddBlueprint(thrown.blueprint);
    m_world->AddBlueprint(other.blueprint);
    const double share = m_random.Draw(0, 1);  // of the speed that the target itself has
    m_world->AddBody(0, -apart * m_direction + across, (1 - share) * m_shot.speed * m_direction);
    m_world->AddBody(1, Vector3d::Zero(), -share * m_shot.speed * m_direction);
    m_shot.offset = across.norm() / m_sumOfRadii;
    m_nearest = apart;
  }

  // A plane has any slope. A wall is a box of 0.25 m across the shot, too wide to go around.
  void AimAtWall(const Thrown& thrown) {
    m_world->AddBlueprint(thrown.blueprint);
    Obstacle obstacle;
    if (m_shot.target == ShotTarget::kPlane) {
      obstacle.normal = m_random.DrawDirection();
    } else {
      obstacle.kind = Obstacle::Kind::kBox;
      obstacle.halfExtents = Vector3d(20, 20, 0.125);
      obstacle.centre = Vector3d(0, 0, -0.125);
    }
    m_world->AddObstacle(obstacle);
    m_normal = obstacle.normal;
    const Vector3d aside = m_random.DrawDirection();
    m_direction = -(m_normal + 0.8 * m_random.Draw(0, 1) * aside).normalized();
    m_world->AddBody(0, (thrown.blueprint.reach + m_gap) * m_normal, m_shot.speed * m_direction);
  }

  void AimAtSheet(const Thrown& thrown) {
    constexpr int kCells = 20;
    constexpr double kCellSize = 0.2;
    m_world->AddBlueprint(thrown.blueprint);
    m_world->AddBlueprint(MakeSheet(kCells, kCellSize, m_random.Draw(20, 80), 4000));
    const double side = m_random.Choose(2) == 0 ? 1 : -1;
    m_direction = (side * Vector3d(0, 0, -1) + 0.5 * m_random.DrawDirection()).normalized();
    const Vector3d aim = m_random.DrawWithin({-0.8, -0.8, 0}, {0.8, 0.8, 0});
    m_world->AddBody(0, aim - (thrown.blueprint.reach + m_gap) / std::fabs(m_direction.z()) * m_direction,
                     m_shot.speed * m_direction);
    m_world->AddBody(1, Vector3d::Zero());
    WatchSheet();
  }

  void Watch() {
    if (m_shot.target == ShotTarget::kBody) {
      m_nearest = std::min(m_nearest, (m_world->FindCentre(Thrower()) - m_world->FindCentre(Target())).norm());
      if (m_nearest > 2 * m_sumOfRadii) return;
      m_shot.depth = std::max({m_shot.depth, FindDeepest(Thrower(), Target()), FindDeepest(Target(), Thrower())});
    } else if (m_shot.target == ShotTarget::kSheet) {
      WatchSheet();
    } else {
      for (const Vector3d& p : ReadPositions(Thrower())) m_shot.depth = std::max(m_shot.depth, -m_normal.dot(p));
    }
  }

  double FindDeepest(const Body& ofVertices, const Body& ofFaces) const {
    return FindDeepestInside(ReadPositions(ofVertices), m_world->BlueprintOf(ofFaces).full.faces,
                             ReadPositions(ofFaces));
  }

  void WatchSheet() {
    const std::vector<Face>& faces = m_world->BlueprintOf(Target()).full.faces;
    const std::vector<Vector3d> sheet = ReadPositions(Target());
    std::vector<Vector3d> points = ReadPositions(Thrower());
    points.push_back(m_world->FindCentre(Thrower()));
    std::vector<double> turns;
    for (const Vector3d& p : points) turns.push_back(FindWinding(faces, sheet, p));
    m_side.resize(points.size(), 0);
    for (std::size_t i = 0; i < m_turns.size(); ++i) {
      if (std::fabs(turns[i] - m_turns[i]) > 0.5) m_side[i] += turns[i] > m_turns[i] ? 1 : -1;
    }
    m_turns = std::move(turns);
    m_countBehind = 0;
    for (std::size_t i = 0; i < m_side.size(); ++i) {
      const double behind = m_side[i] != 0 ? FindDistance(points[i], faces, sheet) : 0;
      m_shot.depth = std::max(m_shot.depth, behind);
      m_countBehind += behind > kBehindShare * m_world->Blueprints()[0].size ? 1 : 0;
    }
    m_shot.snagged = m_countBehind > 0;
  }

  bool HasGoneThrough() const {
    if (m_shot.target == ShotTarget::kSheet) {
      return m_side.back() != 0 || m_countBehind * 20 > m_side.size();
    }
    if (m_shot.target != ShotTarget::kBody) {
      const std::vector<Vector3d> x = ReadPositions(Thrower());
      return m_normal.dot(m_world->FindCentre(Thrower())) < 0 ||
             std::any_of(x.begin(), x.end(), [this](const Vector3d& p) { return m_normal.dot(p) < -kBehind; });
    }
    if (HasDeepVertex(Thrower(), Target()) || HasDeepVertex(Target(), Thrower())) return true;
    const Vector3d between = m_world->FindCentre(Target()) - m_world->FindCentre(Thrower());
    return between.dot(m_direction) < 0 && m_nearest < m_sumOfRadii / 2 &&
           m_shot.depth > kDeepShare * std::min(m_world->Blueprints()[0].size, m_world->Blueprints()[1].size);
  }

  bool HasDeepVertex(const Body& ofVertices, const Body& ofFaces) const {
    const Vector3d middle = m_world->FindCentre(ofFaces);
    const std::vector<Vector3d> skin = ReadPositions(ofFaces);
    const std::vector<Vector3d> x = ReadPositions(ofVertices);
    const std::vector<Face>& faces = m_world->BlueprintOf(ofFaces).full.faces;
    return std::any_of(x.begin(), x.end(), [&](const Vector3d& p) {
      return FindWinding(faces, skin, middle + (p - middle) / kDeep) > 0.5;
    });
  }

  Random m_random;
  bool m_firm;
  double m_share;  // of the material's normal contact stiffness
  Shot m_shot;
  std::unique_ptr<World> m_world;
  Vector3d m_direction = Vector3d::Zero();
  Vector3d m_normal = Vector3d::Zero();
  double m_radius = 0;
  double m_gap = 0;
  double m_sumOfRadii = 0;
  double m_nearest = 0;         // closest approach of the centres, m
  std::vector<double> m_turns;  // of each vertex, then the centre, at the last tick
  std::vector<int> m_side;      // of each; 0 on the side from which it came
  std::size_t m_countBehind = 0;
};

}  // namespace

const char* NameTarget(ShotTarget target) {
  constexpr const char* kNames[] = {"body", "plane", "wall", "sheet"};
  return kNames[static_cast<std::size_t>(target)];
}

Shot PlayShot(std::uint64_t seed, std::uint32_t number, ShotKind kind) {
  constexpr ShotTarget kTargets[] = {ShotTarget::kBody,  ShotTarget::kPlane, ShotTarget::kBody,
                                     ShotTarget::kSheet, ShotTarget::kBody,  ShotTarget::kWall};
  const ShotTarget target = kTargets[number % std::size(kTargets)];
  return Trial(seed * 1000003 + number, target, kind != ShotKind::kSoft, kind == ShotKind::kGhost ? kGhost : 1).Play();
}

namespace {

nlohmann::ordered_json MakeRow(std::uint32_t number, const Shot& shot) {
  return {{"experiment", "shot"},
          {"trial", number},
          {"target", NameTarget(shot.target)},
          {"bodies", shot.bodies},
          {"speed", shot.speed},
          {"offset", shot.offset},
          {"depth", shot.depth},
          {"most_substeps", shot.mostSubsteps},
          {"through", shot.through},
          {"snagged", shot.snagged},
          {"inverted", shot.inverted},
          {"non_finite", shot.nonFinite}};
}

}  // namespace

void MeasureShots(Bench& bench) {
  const Options& options = bench.options;
  std::vector<std::uint32_t> numbers;
  if (options.trial) {
    numbers = {*options.trial};
  } else {
    for (std::uint32_t i = 0; i < (options.quick ? 20U : 1000U); ++i) numbers.push_back(i);
  }
  std::vector<Shot> shots(numbers.size());
  const std::uint32_t others = options.trial ? 0 : options.quick ? 4 : 120;
  std::vector<Shot> soft(others);
  std::vector<Shot> ghosts(others);
  const bool done = RunTrials(bench, shots.size() + others, [&](std::size_t i) {
    if (i < shots.size()) {
      shots[i] = PlayShot(options.seed, numbers[i], ShotKind::kFirm);
    } else {
      const std::size_t k = i - shots.size();
      soft[k] = PlayShot(options.seed, static_cast<std::uint32_t>(k), ShotKind::kSoft);
      ghosts[k] = PlayShot(options.seed, static_cast<std::uint32_t>(k), ShotKind::kGhost);
    }
  });
  if (!done) return;

  double through = 0, inverted = 0, nonFinite = 0, deepest = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Shot& shot = shots[i];
    through += shot.through ? 1 : 0;
    inverted += shot.inverted > 0 ? 1 : 0;
    nonFinite += shot.nonFinite > 0 ? 1 : 0;
    deepest = std::max(deepest, shot.depth);
    bench.results.rows.push_back(MakeRow(numbers[i], shot));
    if (!shot.through && shot.inverted + shot.nonFinite == 0 && !options.trial) continue;
    char line[256];
    std::snprintf(line, sizeof line, "shot --trial %u: %s, %s at %.1f m/s%s%s%s, depth %.3f m, %.0f substeps",
                  numbers[i], NameTarget(shot.target), shot.bodies.c_str(), shot.speed, shot.through ? ", THROUGH" : "",
                  shot.inverted > 0 ? ", inverted" : "", shot.nonFinite > 0 ? ", not finite" : "", shot.depth,
                  shot.mostSubsteps);
    bench.results.remarks.emplace_back(line);
  }
  bench.results.AddFigure("shots", static_cast<double>(shots.size()));
  bench.results.AddFigureAtMost("tunnelled", through, 0);
  bench.results.AddFigureAtMost("inverted", inverted, 0);
  bench.results.AddFigureAtMost("non_finite", nonFinite, 0);
  bench.results.AddFigure("penetration_max", deepest);
  const auto isSnagged = [](const Shot& shot) { return shot.snagged && !shot.through; };
  bench.results.AddFigure("snagged", static_cast<double>(std::count_if(shots.begin(), shots.end(), isSnagged)));
  if (options.trial) return;
  const auto share = [&soft](auto&& predicate) {
    return static_cast<double>(std::count_if(soft.begin(), soft.end(), predicate)) / static_cast<double>(soft.size());
  };
  bench.results.AddFigure("soft_tunnelled_share", share([](const Shot& shot) { return shot.through; }));
  bench.results.AddFigure("soft_inverted_share", share([](const Shot& shot) { return shot.inverted > 0; }));

  // Central shots, which must come out on the far side without contact.
  std::size_t meant = 0, seen = 0;
  for (const Shot& ghost : ghosts) {
    if (ghost.target == ShotTarget::kBody && ghost.offset > 0.4) continue;
    ++meant;
    seen += ghost.through ? 1 : 0;
  }
  bench.results.AddFigureAtMost("ghosts_unnoticed", static_cast<double>(meant - seen), 0);
  Plot plot{
      .name = "penetration", .title = "Deepest vertex of each shot", .xLabel = "speed, m/s", .yLabel = "depth, m"};
  for (const ShotTarget target : {ShotTarget::kBody, ShotTarget::kPlane, ShotTarget::kWall, ShotTarget::kSheet}) {
    Series series{NameTarget(target), Stroke::kPoints, {}};
    for (const Shot& shot : shots) {
      if (shot.target == target) series.points.push_back({shot.speed, shot.depth});
    }
    plot.series.push_back(std::move(series));
  }
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace wobble::bench
