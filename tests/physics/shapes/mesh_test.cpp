// Bodies from meshes: they hold any shape, and the faults of bad meshes are listed face by face.
#include "server/physics/shapes/mesh.h"

#include <gtest/gtest.h>

#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

MeshDefinition MakeSphereMesh() {
  const Icosphere sphere = MakeIcosphere(2);
  MeshDefinition mesh;
  mesh.vertices = sphere.vertices;
  mesh.faces = sphere.faces;
  mesh.scale = 0.5;
  mesh.material.gas = 100;
  mesh.material.stiffness = 600;
  return mesh;
}

// Two bulges with a waist of half their width: concave all round the middle.
MeshDefinition MakePeanut() {
  MeshDefinition mesh = MakeSphereMesh();
  for (Vector3d& x : mesh.vertices) {
    const double width = 1 - 0.5 * std::exp(-8 * x.z() * x.z());
    x = Vector3d(0.8 * width * x.x(), 0.8 * width * x.y(), 1.6 * x.z());
  }
  return mesh;
}

double FindWorstAcceleration(const Blueprint& mesh) {
  const std::vector<Vector3d> v(mesh.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> a(mesh.rest.size());
  ComputeAccelerations<double>(mesh.full, Load<double>{}, {}, {}, mesh.rest, v, a);
  double worst = 0;
  for (const Vector3d& value : a) worst = std::max(worst, value.norm());
  return worst;
}

TEST(Mesh, ClosedOnesHoldTheirShapeAgainstTheirGas) {
  for (const MeshDefinition& definition : {MakeSphereMesh(), MakePeanut()}) {
    const auto errors = ValidateMesh(definition);
    ASSERT_TRUE(errors.empty()) << errors[0].field << " " << errors[0].range;
    const Blueprint mesh = MakeMesh(definition);
    EXPECT_LT(FindWorstAcceleration(mesh), 2e-3);
    Vector3d centre = Vector3d::Zero();
    for (const Vector3d& x : definition.vertices) centre += 0.5 * x / static_cast<double>(definition.vertices.size());
    for (std::size_t i = 0; i < mesh.rest.size(); ++i) {
      EXPECT_LT((mesh.rest[i] - (0.5 * definition.vertices[i] - centre)).norm(), 0.02) << i;
    }
  }
}

TEST(Mesh, FallsOnAFloorAndHolds) {
  World world{WorldSettings{}};
  world.AddBlueprint(MakeMesh(MakePeanut()));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 1.5));
  for (int tick = 0; tick < 600; ++tick) {
    const StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite + report.inverted, 0U) << tick;
  }
  const Blueprint& mesh = world.Blueprints()[0];
  std::vector<Vector3d> x(mesh.rest.size());
  VisitVertices(world.ReadBody(id), [&](std::size_t i, const Vector3d& at) { x[i] = at; });
  EXPECT_GT(ComputeVolume<double>(mesh.full.faces, x), 0.7 * mesh.restVolume);
}

TEST(Mesh, AnOpenOneIsClothOfThisCut) {
  MeshDefinition half = MakeSphereMesh();
  std::erase_if(half.faces, [&](const Face& face) {
    return std::ranges::any_of(face, [&](std::uint16_t i) { return half.vertices[i].z() < -0.05; });
  });
  // Only vertices that a face uses.
  std::vector<int> places(half.vertices.size(), -1);
  std::vector<Vector3d> used;
  for (Face& face : half.faces) {
    for (std::uint16_t& vertex : face) {
      if (places[vertex] < 0) {
        places[vertex] = static_cast<int>(used.size());
        used.push_back(half.vertices[vertex]);
      }
      vertex = static_cast<std::uint16_t>(places[vertex]);
    }
  }
  half.vertices = used;
  ASSERT_EQ(ValidateMesh(half).size(), 1U);
  EXPECT_EQ(ValidateMesh(half)[0].field, "gas");
  EXPECT_EQ(ValidateMesh(half)[0].range, "0: the mesh is open");
  half.material.gas = 0;
  ASSERT_TRUE(ValidateMesh(half).empty());
  const Blueprint bowl = MakeMesh(half);
  EXPECT_EQ(bowl.restVolume, 0);
  EXPECT_LT(FindWorstAcceleration(bowl), 1e-9);
}

TEST(Mesh, FaultsNameTheFace) {
  const std::vector<Vector3d> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {2, 0, 0}};
  const auto only = [&](const std::vector<Face>& faces) {
    const std::vector<MeshFault> faults = FindMeshFaults(x, faces);
    EXPECT_EQ(faults.size(), 1U);
    return faults.empty() ? std::string() : std::to_string(faults[0].face) + " " + faults[0].what;
  };
  EXPECT_TRUE(FindMeshFaults(x, std::vector<Face>{{0, 1, 2}, {1, 0, 3}}).empty());
  EXPECT_EQ(only({{0, 1, 2}, {1, 0, 6}}), "1 has vertex 7 of 6");
  EXPECT_EQ(only({{0, 1, 2}, {3, 4, 3}}), "1 has vertex 4 twice");
  EXPECT_EQ(only({{0, 1, 5}, {0, 1, 2}}), "0 has no area");
  EXPECT_EQ(only({{0, 1, 2}, {0, 1, 3}}), "1 is wound against its neighbour on side 1-2");
  EXPECT_EQ(only({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), "2 is the third on side 1-2");
}

TEST(Mesh, ValidateNamesFieldValueAndRange) {
  const auto only = [](const MeshDefinition& mesh) {
    const auto errors = ValidateMesh(mesh);
    EXPECT_EQ(errors.size(), 1U);
    return errors.empty() ? std::string() : errors[0].field + " = " + errors[0].value + ": " + errors[0].range;
  };
  MeshDefinition mesh = MakeSphereMesh();
  for (Face& face : mesh.faces) std::swap(face[1], face[2]);
  EXPECT_EQ(only(mesh), "file = faces look inward: a closed mesh whose faces are counter-clockwise seen from outside");
  mesh = MakeSphereMesh();
  mesh.material.gas = 1e6;
  EXPECT_NE(only(mesh).find("at most"), std::string::npos);
  mesh = MakeSphereMesh();
  mesh.vertices.emplace_back(0, 0, 9);
  EXPECT_NE(only(mesh).find("one piece"), std::string::npos);
  mesh = MakeSphereMesh();
  mesh.faces.clear();
  EXPECT_NE(only(mesh).find("no faces"), std::string::npos);
  mesh = MakeSphereMesh();
  mesh.scale = 0.01;
  EXPECT_NE(only(mesh).find("0.05 to 100 m"), std::string::npos);
  mesh = MakeSphereMesh();
  mesh.material.stiffness = 1e8;
  EXPECT_NE(only(mesh).find("stiffness"), std::string::npos);
}

}  // namespace
}  // namespace wobble::physics
