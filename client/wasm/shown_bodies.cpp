// Most bodies of a large scene are at rest. So vertices are compared, which is ten times cheaper than computing normals
// and uploading both to the graphics card, and only changed bodies get a new revision.
#include "client/wasm/shown_bodies.h"

#include <cstring>
#include <iterator>

#include "client/normals.h"

namespace wobble::wasm {
namespace {

template <typename Map>
void DropUnused(Map& map, std::uint32_t round) {
  for (auto entry = map.begin(); entry != map.end();) {
    entry = entry->second.round == round ? std::next(entry) : map.erase(entry);
  }
}

bool AreSame(std::span<const protocol::Vector3> a, std::span<const protocol::Vector3> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

void ShownBodies::Update(std::span<const client::BodySample> samples) {
  ++m_round;
  m_views.clear();
  for (const client::BodySample& sample : samples) {
    Named& named = Name(sample.blueprint);
    Shown& shown = m_shown[sample.body];
    shown.round = m_round;
    Take(sample, shown, shown.blueprint != named.number);
    shown.blueprint = named.number;

    BodyView& view = m_views.emplace_back();
    view.body = sample.body;
    view.blueprint = shown.blueprint;
    view.revision = shown.revision;
    view.vertexCount = static_cast<std::uint32_t>(shown.vertices.size());
    view.vertices = AddressOf(shown.vertices.data());
    view.normals = AddressOf(shown.normals.data());
    const auto& [centroid, rotation] = sample.pose;
    view.centroid[0] = centroid.x, view.centroid[1] = centroid.y, view.centroid[2] = centroid.z;
    view.rotation[0] = rotation.w, view.rotation[1] = rotation.x;
    view.rotation[2] = rotation.y, view.rotation[3] = rotation.z;
    view.held = sample.held ? 1 : 0;
  }
  DropUnused(m_shown, m_round);
  DropUnused(m_blueprints, m_round);
}

ShownBodies::Named& ShownBodies::Name(const std::shared_ptr<const client::Blueprint>& blueprint) {
  Named& named = m_blueprints[blueprint.get()];
  if (named.blueprint == nullptr) {
    named.blueprint = blueprint;
    named.number = m_nextNumber++;
  }
  named.round = m_round;
  return named;
}

void ShownBodies::Take(const client::BodySample& sample, Shown& shown, bool isOtherBlueprint) {
  if (!isOtherBlueprint && AreSame(shown.vertices, sample.vertices)) return;
  shown.vertices = sample.vertices;
  shown.normals.resize(sample.blueprint->faces.empty() ? 0 : shown.vertices.size());
  client::FindNormals(shown.vertices, sample.blueprint->faces, shown.normals);
  ++shown.revision;
}

const BlueprintView* ShownBodies::FindBlueprint(std::uint32_t number) {
  for (const auto& [pointer, named] : m_blueprints) {
    if (named.number != number) continue;
    const client::Blueprint& blueprint = *pointer;
    BlueprintView& view = m_blueprintView;
    view.vertexCount = static_cast<std::uint32_t>(blueprint.rest.size());
    view.rest = AddressOf(blueprint.rest.data());
    view.faceCount = static_cast<std::uint32_t>(blueprint.faces.size());
    view.faces = AddressOf(blueprint.faces.data());
    view.edgeCount = static_cast<std::uint32_t>(blueprint.edges.size());
    view.edges = AddressOf(blueprint.edges.data());
    view.size = blueprint.size;
    view.isOpen = blueprint.open ? 1 : 0;
    view.name = MakeText(blueprint.name);
    view.particles = blueprint.particles.empty() ? 0 : AddressOf(blueprint.particles.data());
    view.springs = blueprint.springs.empty() ? 0 : AddressOf(blueprint.springs.data());
    return &view;
  }
  return nullptr;
}

}  // namespace wobble::wasm
