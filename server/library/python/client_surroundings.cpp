// Obstacles and grounds of a client's world.
#include "server/library/python/client.h"

namespace wobble::python {
namespace {

const char* NameKind(const Obstacle& obstacle) {
  constexpr const char* kNames[] = {"plane", "box", "sphere", "capsule"};
  const std::int32_t kind = obstacle.read.kind;
  return kind >= WOBBLE_PLANE && kind <= WOBBLE_CAPSULE ? kNames[kind] : "unknown";
}

}  // namespace

std::vector<Obstacle> ListObstacles(Player& player) {
  std::vector<Obstacle> obstacles;
  Ask(player, "obstacles", [&](wobble_client* client) {
    auto read = MakeStruct<wobble_obstacle>();
    for (std::uint32_t i = 0; wobble_read_obstacle(client, i, &read) == WOBBLE_OK; ++i) obstacles.push_back({read});
    return WOBBLE_OK;
  });
  return obstacles;
}

// The heights are copied in the same turn in which they are found: the next update may free them.
std::vector<Ground> ListGrounds(Player& player) {
  std::vector<wobble_ground> found;
  std::vector<std::vector<float>> heights;
  Ask(player, "grounds", [&](wobble_client* client) {
    auto read = MakeStruct<wobble_ground>();
    for (std::uint32_t i = 0; wobble_read_ground(client, i, &read) == WOBBLE_OK; ++i) {
      found.push_back(read);
      heights.emplace_back(read.heights, read.heights + std::size_t{read.columns} * read.rows);
    }
    return WOBBLE_OK;
  });
  std::vector<Ground> grounds;
  for (std::size_t i = 0; i < found.size(); ++i) {
    grounds.push_back(
        {found[i], CopyRows(heights[i].data(), py::ssize_t{found[i].rows}, py::ssize_t{found[i].columns})});
  }
  return grounds;
}

void DefineSurroundings(py::module_& module) {
  py::class_<Obstacle>(module, "Obstacle", R"(What stands still, m, world.

Plane: a is the outward normal, b[0] the offset (a . x = offset). Box, parallel to the axes: a is the centre, b the half
extents. Sphere: a is the centre. Capsule: a and b are the ends of its axis.)")
      .def_property_readonly("kind", &NameKind, "plane, box, sphere or capsule.")
      .def_property_readonly("a", [](const Obstacle& obstacle) { return py::array_t<float>(3, obstacle.read.a); })
      .def_property_readonly("b", [](const Obstacle& obstacle) { return py::array_t<float>(3, obstacle.read.b); })
      .def_property_readonly(
          "radius", [](const Obstacle& obstacle) { return obstacle.read.radius; }, "Of sphere and capsule.");
  py::class_<Ground>(module, "Ground",
                     "Heights over a grid, solid below: heights[j, i] is at corner + cell_size (i, j).")
      .def_property_readonly(
          "corner", [](const Ground& ground) { return py::array_t<float>(2, ground.read.corner); }, "m, x and y.")
      .def_property_readonly(
          "cell_size", [](const Ground& ground) { return ground.read.cell_size; }, "m.")
      .def_readonly("heights", &Ground::heights, "float32 (rows along y, columns along x), m, world.");
}

}  // namespace wobble::python
