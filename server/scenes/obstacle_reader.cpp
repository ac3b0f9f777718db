#include "server/scenes/obstacle_reader.h"

#include <cmath>

namespace wobble::scenes {
namespace {

void ReadPlane(TableReader& reader, physics::Obstacle& plane) {
  reader.Read("normal", -1, 1, "", plane.normal);
  if (const double length = plane.normal.norm(); length > 1e-6) {
    // What is a unit vector already stays as it is to the bit: scenes are also written by programs.
    if (std::abs(length - 1) > 1e-15) plane.normal /= length;
  } else {
    reader.Refuse("normal", "[0, 0, 0]", "a direction");
  }
  reader.Read("offset", -kPlacesWithin, kPlacesWithin, " m", plane.offset);
}

// Returns false when there are no valid heights.
bool ReadHeightField(TableReader& reader, physics::Obstacle& ground) {
  reader.Read("position", -kPlacesWithin, kPlacesWithin, " m", ground.centre);
  double cellSize = 1;
  reader.Read("cell_size", 0.05, 100, " m", cellSize);
  reader.Require("heights");
  std::vector<double> heights;
  int columns = 0;
  if (!reader.Read("heights", -1000, 1000, " m", physics::kMaxFieldNodes, heights, columns)) return false;
  ground.field = physics::MakeHeightField(columns, cellSize, heights);
  return true;
}

}  // namespace

void ReadObstacle(TableReader& reader, Scene& scene) {
  physics::Obstacle obstacle;
  using Kind = physics::Obstacle::Kind;
  reader.Require("kind");
  const std::map<std::string, Kind> kinds{{"plane", Kind::kPlane},
                                          {"box", Kind::kBox},
                                          {"sphere", Kind::kSphere},
                                          {"capsule", Kind::kCapsule},
                                          {"height_field", Kind::kHeightField}};
  if (!reader.Read("kind", kinds, obstacle.kind)) return reader.PassOver();
  reader.Read("friction", 0, 10, "", obstacle.friction);
  switch (obstacle.kind) {
    case Kind::kPlane:
      ReadPlane(reader, obstacle);
      break;
    case Kind::kBox:
      reader.Read("center", -kPlacesWithin, kPlacesWithin, " m", obstacle.centre);
      reader.Read("half_extents", physics::kMinHalfExtent, kPlacesWithin, " m", obstacle.halfExtents);
      break;
    case Kind::kSphere:
      reader.Read("center", -kPlacesWithin, kPlacesWithin, " m", obstacle.centre);
      reader.Read("radius", physics::kMinRadius, 1000, " m", obstacle.radius);
      break;
    case Kind::kCapsule:
      reader.Require("from");
      reader.Require("to");
      reader.Read("from", -kPlacesWithin, kPlacesWithin, " m", obstacle.centre);
      reader.Read("to", -kPlacesWithin, kPlacesWithin, " m", obstacle.end);
      reader.Read("radius", physics::kMinRadius, 1000, " m", obstacle.radius);
      break;
    case Kind::kHeightField:
      if (!ReadHeightField(reader, obstacle)) return;
      break;
  }
  scene.obstacles.push_back(obstacle);
}

}  // namespace wobble::scenes
