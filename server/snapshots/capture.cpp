// The pose of a soft body is its centroid and the rotation that brings the rest shape nearest to the present shape. The
// search for it starts from the last capture.
#include "server/snapshots/capture.h"

#include <algorithm>
#include <cmath>

#include "protocol/codec/basis_reader.h"
#include "protocol/snapshot.h"
#include "server/physics/inspect.h"
#include "server/physics/model/rotation.h"

namespace wobble::server {
namespace {

using physics::Vector3f;
using protocol::Vector3;

protocol::wire::Vec3 ToMessage(const physics::Vector3d& v) {
  const Vector3 w = ToWire(v);
  return {w.x, w.y, w.z};
}

// Resolution of the ground that clients draw: up to kMostCells cells for each cell of the field, as long as that makes
// no more than kDrawnCells along an axis.
constexpr int kDrawnCells = 64;
constexpr int kMostCells = 8;

physics::Vector3d FromWire(const Vector3& v) { return Vector3f(v.x, v.y, v.z).cast<double>(); }

Vector3 FindCentroid(std::span<const Vector3> vertices) {
  physics::Vector3d sum = physics::Vector3d::Zero();
  for (const Vector3& v : vertices) sum += FromWire(v);
  return ToWire(physics::Vector3d(sum / static_cast<double>(vertices.size())));
}

// Samples the surface rather than the heights that it was made from, so that a client need not know the interpolation
// between them.
CapturedGround CaptureGround(const physics::Obstacle& obstacle) {
  static_assert(protocol::kMaxFieldNodes >= std::size_t{physics::kMaxFieldNodes});
  const physics::HeightField& field = *obstacle.field;
  const int cells = std::clamp(kDrawnCells / (std::max(field.columns, field.rows) - 1), 1, kMostCells);
  const int columns = (field.columns - 1) * cells + 1;
  const int rows = (field.rows - 1) * cells + 1;
  const double cellSize = field.cellSize / cells;
  std::vector<double> heights;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      heights.push_back(physics::FindHeight(field, cellSize * column, cellSize * row));
    }
  }
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double step = (*high - *low) / 65535;
  CapturedGround captured;
  // Origin, cell size, base height, height step, columns, rows.
  captured.field = {ToMessage(obstacle.centre), static_cast<float>(cellSize),        static_cast<float>(*low),
                    static_cast<float>(step),   static_cast<std::uint16_t>(columns), static_cast<std::uint16_t>(rows)};
  for (const double height : heights) {
    const double steps = step > 0 ? std::nearbyint((height - *low) / step) : 0;
    captured.heights.push_back(static_cast<std::uint16_t>(std::clamp(steps, 0.0, 65535.0)));
  }
  return captured;
}

// The springs to draw of a blueprint without faces: the first protocol::kMaxBlueprintEdges.
std::vector<std::array<std::uint16_t, 2>> FindEdges(const physics::Blueprint& blueprint) {
  std::vector<std::array<std::uint16_t, 2>> edges;
  for (const physics::Spring<double>& spring : blueprint.full.springs) {
    if (edges.size() == protocol::kMaxBlueprintEdges) break;
    edges.push_back({static_cast<std::uint16_t>(spring.a), static_cast<std::uint16_t>(spring.b)});
  }
  return edges;
}

}  // namespace

Vector3 ToWire(const physics::Vector3d& v) {
  const Vector3f single = v.cast<float>();
  return {single.x(), single.y(), single.z()};
}

CapturedBlueprint CaptureBlueprint(const physics::Blueprint& blueprint,
                                   std::span<const std::vector<std::uint8_t>> bases, const BlueprintTags& tags) {
  CapturedBlueprint captured;
  std::vector<std::array<std::uint16_t, 2>> edges;
  if (blueprint.full.faces.empty()) edges = FindEdges(blueprint);
  for (const physics::Vector3d& x : blueprint.rest) captured.rest.push_back(ToWire(x));
  captured.size = static_cast<float>(blueprint.size);
  captured.message = protocol::MakeBlueprint({.name = blueprint.name,
                                              .rest = captured.rest,
                                              .faces = blueprint.full.faces,
                                              .size = captured.size,
                                              .edges = edges,
                                              .bases = bases,
                                              .particles = tags.particles,
                                              .springs = tags.springs});
  captured.patches = protocol::FindPatchConstants(captured.rest);
  for (std::size_t patch = 0; patch < bases.size(); ++patch) {
    captured.patches[patch].basis = protocol::ReadBasis(bases[patch], protocol::PatchSize(captured.rest.size(), patch));
  }
  captured.hash = protocol::HashBytes(captured.message);
  return captured;
}

BlueprintTags CaptureTags(const physics::Blueprint& blueprint, std::span<const PartTag> particles,
                          std::span<const PartTag> springs) {
  const physics::Coefficients<double>& full = blueprint.full;
  BlueprintTags tags;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const bool isFixed = std::ranges::find(full.fixed, i) != full.fixed.end();
    tags.particles.emplace_back(static_cast<float>(full.masses[i]), particles[i].owner, particles[i].number, isFixed);
  }
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const physics::Spring<double>& spring = full.springs[i];
    tags.springs.emplace_back(static_cast<float>(spring.stiffness), static_cast<float>(spring.damping),
                              static_cast<float>(spring.restLength), springs[i].owner, springs[i].number);
  }
  return tags;
}

std::uint8_t CaptureHands(const scenes::Scene& scene) {
  const scenes::HandRules& hands = scene.hands;
  return static_cast<std::uint8_t>((hands.grab ? protocol::kMayGrab : 0) | (hands.cut ? protocol::kMayCut : 0) |
                                   (hands.push ? protocol::kMayPush : 0) |
                                   (scene.workshop.isOpen ? protocol::kMayBuild : 0));
}

protocol::wire::Drive CaptureDrive(const scenes::Scene& scene) {
  const physics::ControlLimits& limits = scene.player.limits;
  return {static_cast<float>(limits.acceleration), static_cast<float>(limits.speed),
          static_cast<float>(limits.jumpSpeed)};
}

protocol::TuningFields CaptureTuning(const Tuning& tuning, double timeRate, bool isSpectator, bool isHost) {
  using Kind = TuneCommand::Kind;
  const auto bit = [&](Kind kind, std::uint8_t value) {
    return static_cast<unsigned>(!isSpectator && tuning.MayTune(kind, isHost) ? value : 0);
  };
  protocol::TuningFields fields;
  fields.gravity = ToWire(tuning.Gravity());
  fields.stiffness = static_cast<float>(tuning.Stiffness());
  fields.timeRate = static_cast<float>(timeRate);
  fields.may = static_cast<std::uint8_t>(bit(Kind::kGravity, protocol::kMayTuneGravity) |
                                         bit(Kind::kStiffness, protocol::kMayTuneStiffness) |
                                         bit(Kind::kTimeRate, protocol::kMayTuneTime));
  return fields;
}

std::vector<protocol::wire::Obstacle> CaptureObstacles(std::span<const physics::Obstacle> obstacles) {
  using Kind = physics::Obstacle::Kind;
  namespace wire = protocol::wire;
  std::vector<wire::Obstacle> captured;
  for (const physics::Obstacle& obstacle : obstacles) {
    const auto radius = static_cast<float>(obstacle.radius);
    switch (obstacle.kind) {
      case Kind::kPlane:
        captured.emplace_back(wire::ObstacleKind::Plane, ToMessage(obstacle.normal),
                              wire::Vec3(static_cast<float>(obstacle.offset), 0, 0), 0.0F);
        break;
      case Kind::kBox:
        captured.emplace_back(wire::ObstacleKind::Box, ToMessage(obstacle.centre), ToMessage(obstacle.halfExtents),
                              0.0F);
        break;
      case Kind::kSphere:
        captured.emplace_back(wire::ObstacleKind::Sphere, ToMessage(obstacle.centre), wire::Vec3(), radius);
        break;
      case Kind::kCapsule:
        captured.emplace_back(wire::ObstacleKind::Capsule, ToMessage(obstacle.centre), ToMessage(obstacle.end), radius);
        break;
      case Kind::kHeightField:
        break;
    }
  }
  return captured;
}

std::vector<CapturedGround> CaptureGrounds(std::span<const physics::Obstacle> obstacles) {
  std::vector<CapturedGround> captured;
  for (const physics::Obstacle& obstacle : obstacles) {
    if (obstacle.kind == physics::Obstacle::Kind::kHeightField) captured.push_back(CaptureGround(obstacle));
  }
  return captured;
}

protocol::Message CaptureForces(const physics::World& world, physics::BodyId body, std::uint32_t tick) {
  using Kind = protocol::wire::ForceKind;
  const physics::InspectedForces forces = physics::InspectForces(world, body);
  const std::size_t stride = (forces.weight.size() + protocol::kMaxShownForces - 1) / protocol::kMaxShownForces;
  std::vector<protocol::ForceField> fields;
  const auto add = [&](Kind kind, const std::vector<physics::Vector3d>& values) {
    protocol::ForceField& field = fields.emplace_back();
    field.kind = kind;
    for (std::size_t i = 0; i < values.size(); i += stride) field.values.push_back(ToWire(values[i]));
  };
  add(Kind::Elastic, forces.elastic);
  add(Kind::Damping, forces.damping);
  add(Kind::Gas, forces.gas);
  add(Kind::Weight, forces.weight);
  add(Kind::Contact, forces.contact);
  add(Kind::Other, forces.other);
  add(Kind::Acceleration, forces.accelerations);
  return protocol::MakeForces(body, tick, static_cast<std::uint16_t>(stride), fields);
}

std::size_t CountRowsAtOnce(const CapturedGround& ground) { return protocol::kMaxRowsHeights / ground.field.columns(); }

protocol::Message MakeRows(std::uint16_t number, const CapturedGround& ground, std::size_t firstRow) {
  const std::size_t columns = ground.field.columns();
  const std::size_t rows = std::min(CountRowsAtOnce(ground), ground.field.rows() - firstRow);
  const std::span<const std::uint16_t> heights = ground.heights;
  return protocol::MakeHeightRows(number, static_cast<std::uint16_t>(firstRow),
                                  heights.subspan(firstRow * columns, rows * columns));
}

protocol::Message MakeChunk(std::uint8_t number, const CapturedBlueprint& blueprint, std::size_t offset) {
  const std::span<const std::uint8_t> whole = blueprint.message;
  const std::size_t size = std::min(protocol::kBlueprintChunkBytes, whole.size() - offset);
  return protocol::MakeBlueprintChunk(number, blueprint.hash, static_cast<std::uint32_t>(whole.size()),
                                      static_cast<std::uint32_t>(offset), whole.subspan(offset, size),
                                      blueprint.generation);
}

void CaptureBody(const physics::World& world, const physics::Body& body, CapturedBody& captured) {
  const physics::Blueprint& blueprint = world.BlueprintOf(body);
  captured.vertices.resize(blueprint.rest.size());
  physics::VisitVertices(body, [&](std::size_t i, const physics::Vector3d& x) { captured.vertices[i] = ToWire(x); });
  captured.body = body.id;
  ++captured.version;
  captured.blueprint = body.blueprint;
  captured.pose.centroid = FindCentroid(captured.vertices);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < captured.vertices.size(); ++i) {
    a += FromWire(captured.vertices[i] - captured.pose.centroid) * blueprint.rest[i].transpose();
  }
  const protocol::Quaternion& last = captured.pose.rotation;
  const Eigen::Quaterniond q = physics::FindRotation(a, Eigen::Quaterniond(last.w, last.x, last.y, last.z));
  captured.pose.rotation = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                            static_cast<float>(q.z())};
}

}  // namespace wobble::server
