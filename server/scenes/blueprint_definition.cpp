// Each function dispatches to an overload per kind, so that the compiler reports an overload that is missing.
#include "server/scenes/blueprint_definition.h"

namespace wobble::scenes {
namespace {

using physics::BallDefinition;
using physics::ClothDefinition;
using physics::GraphDefinition;
using physics::LatticeDefinition;
using physics::MeshDefinition;
using physics::PairDefinition;
using physics::RingDefinition;
using physics::SolidDefinition;

std::size_t CountVerticesOf(const BallDefinition& ball) { return physics::CountVertices(ball.subdivisions); }
std::size_t CountVerticesOf(const LatticeDefinition& lattice) { return physics::CountVertices(lattice.cells); }
std::size_t CountVerticesOf(const PairDefinition& /*pair*/) { return 2; }
std::size_t CountVerticesOf(const RingDefinition& ring) { return static_cast<std::size_t>(ring.points * ring.layers); }
std::size_t CountVerticesOf(const ClothDefinition& cloth) {
  return static_cast<std::size_t>(cloth.points[0] * cloth.points[1]);
}
std::size_t CountVerticesOf(const GraphDefinition& graph) { return graph.particles.size(); }
std::size_t CountVerticesOf(const MeshDefinition& mesh) { return mesh.vertices.size(); }
std::size_t CountVerticesOf(const SolidDefinition& solid) { return physics::CountVertices(solid); }

std::vector<physics::FieldError> ValidateOne(const BallDefinition& ball) { return physics::ValidateBall(ball); }
std::vector<physics::FieldError> ValidateOne(const LatticeDefinition& lattice) {
  return physics::ValidateLattice(lattice);
}
std::vector<physics::FieldError> ValidateOne(const PairDefinition& pair) { return physics::ValidatePair(pair); }
std::vector<physics::FieldError> ValidateOne(const RingDefinition& ring) { return physics::ValidateRing(ring); }
std::vector<physics::FieldError> ValidateOne(const ClothDefinition& cloth) { return physics::ValidateCloth(cloth); }
std::vector<physics::FieldError> ValidateOne(const GraphDefinition& graph) { return physics::ValidateGraph(graph); }
std::vector<physics::FieldError> ValidateOne(const MeshDefinition& mesh) { return physics::ValidateMesh(mesh); }
std::vector<physics::FieldError> ValidateOne(const SolidDefinition& solid) { return physics::ValidateSolid(solid); }

physics::Blueprint MakeOne(const BallDefinition& ball) { return physics::MakeBall(ball); }
physics::Blueprint MakeOne(const LatticeDefinition& lattice) { return physics::MakeLattice(lattice); }
physics::Blueprint MakeOne(const PairDefinition& pair) { return physics::MakePair(pair); }
physics::Blueprint MakeOne(const RingDefinition& ring) { return physics::MakeRing(ring); }
physics::Blueprint MakeOne(const ClothDefinition& cloth) { return physics::MakeCloth(cloth); }
physics::Blueprint MakeOne(const GraphDefinition& graph) { return physics::MakeGraph(graph); }
physics::Blueprint MakeOne(const MeshDefinition& mesh) { return physics::MakeMesh(mesh); }
physics::Blueprint MakeOne(const SolidDefinition& solid) { return physics::MakeSolid(solid); }

}  // namespace

const std::string& NameOf(const BlueprintDefinition& definition) {
  return std::visit([](const auto& one) -> const std::string& { return one.name; }, definition);
}

std::size_t CountVertices(const BlueprintDefinition& definition) {
  return std::visit([](const auto& one) { return CountVerticesOf(one); }, definition);
}

std::vector<physics::FieldError> Validate(const BlueprintDefinition& definition) {
  return std::visit([](const auto& one) { return ValidateOne(one); }, definition);
}

physics::Blueprint MakeBlueprint(const BlueprintDefinition& definition) {
  return std::visit([](const auto& one) { return MakeOne(one); }, definition);
}

}  // namespace wobble::scenes
