// OBJ files: the accepted forms, and the errors of bad files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "server/physics/world.h"
#include "server/scenes/loader.h"
#include "server/scenes/obj_reader.h"
#include "tests/support/pace.h"
#include "tests/support/places.h"

namespace wobble::scenes {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::string kTetrahedron = R"(# a tetrahedron
o thing
v 0 0 0
v 1 0 0 1.0
v 0 1 0
v 0 0 1e0
vn 0 0 1
vt 0.5 0.5
)";

TEST(Obj, CornersMayBeGivenInEveryWay) {
  const ObjMesh mesh =
      ParseObj(kTetrahedron + "f 1 3 2\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1 # side\nf -4/1/1 -1/1/1 -2/1/1\n");
  ASSERT_THAT(mesh.errors, IsEmpty());
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.vertices[3], physics::Vector3d(0, 0, 1));
  EXPECT_THAT(mesh.faces, ElementsAre(physics::Face{0, 2, 1}, physics::Face{0, 1, 3}, physics::Face{1, 2, 3},
                                      physics::Face{0, 3, 2}));
}

TEST(Obj, PolygonsBecomeFansAndLinesMayEndAsOnWindows) {
  const ObjMesh mesh = ParseObj("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3 4\r\n");
  ASSERT_THAT(mesh.errors, IsEmpty());
  EXPECT_THAT(mesh.faces, ElementsAre(physics::Face{0, 1, 2}, physics::Face{0, 2, 3}));
}

TEST(Obj, EveryMistakeHasItsLineAndItsFace) {
  EXPECT_THAT(ParseObj("v 0 0 zero\nv nan 0 0\nv 1 0\n").errors,
              ElementsAre("line 1: vertex 1 has 'zero' where a number belongs",
                          "line 2: vertex 2 has 'nan' where a number belongs",
                          "line 3: vertex 3 has '' where a number belongs"));
  EXPECT_THAT(ParseObj(kTetrahedron + "f 1 3 2\nf 1 2 9\nf 1 2\nf 1 0 2\nf 1 two 3\nf -5 1 2\n").errors,
              ElementsAre("line 10: face 2 has vertex '9' of 4", "line 11: face 3 has 2 corners",
                          "line 12: face 4 has vertex '0' of 4", "line 13: face 5 has 'two' where a vertex belongs",
                          "line 14: face 6 has vertex '-5' of 4"));
  EXPECT_THAT(
      ParseObj(kTetrahedron + "f 1 3 2\nf 1 1 4\nf 1 3 4\n").errors,
      ElementsAre("line 10: face 2 has vertex 1 twice", "line 11: face 3 is wound against its neighbour on side 1-3"));
}

TEST(Obj, TooManyVerticesAreRefusedOnceTheyAre) {
  std::string text;
  for (std::size_t i = 0; i <= physics::kMaxMeshVertices; ++i) text += "v " + std::to_string(i) + " 0 0\n";
  EXPECT_THAT(ParseObj(text).errors, ElementsAre("line 4097: vertex 4097: at most 4096 vertices"));
}

// The shipped creatures: valid meshes of a size fit for play, which keep their shape and survive a fall.
class ShippedMesh : public testing::TestWithParam<std::string> {};

TEST_P(ShippedMesh, LoadsHoldsItsShapeAndBearsAFall) {
  std::string text;
  const ObjMesh obj = LoadObj(test::FindSource("server/scenes/meshes/" + GetParam() + ".obj"), text);
  ASSERT_THAT(obj.errors, IsEmpty());
  EXPECT_GE(obj.vertices.size(), 150U);
  EXPECT_LE(obj.vertices.size(), 450U);
  physics::MeshDefinition mesh;
  mesh.vertices = obj.vertices;
  mesh.faces = obj.faces;
  mesh.bend = 0.5;
  mesh.material.mass = 10;
  mesh.material.stiffness = 1000;
  mesh.material.gas = 120;
  const auto errors = physics::ValidateMesh(mesh);
  ASSERT_TRUE(errors.empty()) << errors[0].field << ": " << errors[0].range;
  physics::World world(physics::WorldSettings{});
  world.AddBlueprint(physics::MakeMesh(mesh));
  world.AddObstacle(physics::Obstacle{});
  const physics::BodyId id = world.AddBody(0, {0, 0, 2});
  for (int tick = 0; tick < test::Shorten(300); ++tick) {
    const physics::StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite + report.inverted, 0U) << tick;
  }
  if (test::kIsSanitized) return;
  const physics::Blueprint& blueprint = world.Blueprints()[0];
  std::vector<physics::Vector3d> x(blueprint.rest.size());
  physics::VisitVertices(world.ReadBody(id), [&](std::size_t i, const physics::Vector3d& at) { x[i] = at; });
  double change = 0;  // of the springs' lengths, RMS
  for (const auto& spring : blueprint.full.springs) {
    const double length = (blueprint.rest[spring.a] - blueprint.rest[spring.b]).norm();
    change += std::pow((x[spring.a] - x[spring.b]).norm() / length - 1, 2);
  }
  change = std::sqrt(change / static_cast<double>(blueprint.full.springs.size()));
  EXPECT_LT(change, 0.05);
}
INSTANTIATE_TEST_SUITE_P(All, ShippedMesh, testing::Values("calf", "caterpillar", "whale"),
                         [](const auto& parameter) { return parameter.param; });

class MeshScene : public testing::Test {
 protected:
  MeshScene() : folder(std::filesystem::temp_directory_path() / ("wobble_obj_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder / "meshes");
  }
  ~MeshScene() override { std::filesystem::remove_all(folder); }

  std::vector<std::string> ErrorsOf(const std::string& obj, const std::string& fields) const {
    std::ofstream(folder / "meshes/it.obj") << obj;
    return ParseScene("[[blueprint]]\nname = \"it\"\nkind = \"mesh\"\nfile = \"meshes/it.obj\"\n" + fields +
                          "[player]\nblueprint = \"it\"\n",
                      (folder / "scene.toml").string())
        .errors;
  }

  std::filesystem::path folder;
};

TEST_F(MeshScene, FindsItsFileBesideTheScene) {
  const std::string whole = kTetrahedron + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  EXPECT_THAT(ErrorsOf(whole, "scale = 0.8\ngas = 5\nbend = 0.2\nmass = 2\nstiffness = 300\n"), IsEmpty());
  EXPECT_THAT(ErrorsOf(whole, "scale = -1\ngas = true\n"),
              ElementsAre(AllOf(StartsWith("scene.toml:5: scale = -1"), HasSubstr("0.001 to 1000")),
                          AllOf(StartsWith("scene.toml:6: gas = true"), HasSubstr("a number, 0 to 1e9 J"))));
  EXPECT_THAT(ErrorsOf(kTetrahedron, ""),
              ElementsAre(AllOf(StartsWith("scene.toml:4: file = "), HasSubstr("at least one face"))));
}

TEST_F(MeshScene, ABadMeshIsRefusedWithFaceAndLine) {
  EXPECT_THAT(
      ErrorsOf(kTetrahedron + "f 1 3 2\nf 1 2 7\n", "gas = 1e30\n"),
      ElementsAre(AllOf(StartsWith("scene.toml:4: file = meshes/it.obj: line 10: face 2 has vertex '7' of 4"))));
  std::filesystem::remove_all(folder / "meshes");
  EXPECT_THAT(ErrorsOf("", ""), ElementsAre(AllOf(StartsWith("scene.toml:4: file = meshes/it.obj: cannot be read"))));
}

}  // namespace
}  // namespace wobble::scenes
