// Any text as a scene, and as a mesh. What is accepted and small is filled into a world and stepped.
#include <cmath>

#include "server/scenes/loader.h"
#include "server/scenes/obj_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

constexpr std::size_t kMostVertices = 300;
constexpr std::size_t kMostBodies = 20;

void Play(const scenes::Scene& scene) {
  std::size_t vertices = 0;
  for (const auto& blueprint : scene.blueprints) vertices += scenes::CountVertices(blueprint);
  if (vertices > kMostVertices || scenes::CountBodies(scene) > kMostBodies) return;
  physics::World world(scenes::MakeWorldSettings(scene, 1.0 / 60, 1));
  static_cast<void>(scenes::FillWorld(scene, 1, world));
  for (int i = 0; i < 2; ++i) static_cast<void>(world.Step());
  for (const physics::Body& body : world.Bodies()) {
    physics::VisitVertices(body, [](std::size_t, const physics::Vector3d& x) { Require(x.allFinite()); });
  }
}

void FuzzOne(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const std::string text(bytes.begin() + 1, bytes.end());
  if (bytes[0] == 'o') {
    const scenes::ObjMesh mesh = scenes::ParseObj(text);
    if (!mesh.errors.empty()) return;
    for (const physics::Face& face : mesh.faces) {
      for (const auto vertex : {face[0], face[1], face[2]}) Require(vertex < mesh.vertices.size());
    }
    return;
  }
  const scenes::LoadResult loaded = scenes::ParseScene(text, "fuzz");
  if (loaded.errors.empty()) Play(loaded.scene);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
