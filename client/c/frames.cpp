// Samples are kept twice, in turn, so that what the caller was given pointers to outlives the next sample. The older
// one also tells which bodies are where they were: comparing costs a tenth of computing normals, and most bodies of a
// large scene are at rest.
#include "client/c/frames.h"

#include <algorithm>
#include <cstring>

#include "client/normals.h"

namespace wobble::c {
namespace {

static_assert(sizeof(protocol::Vector3) == 3 * sizeof(float));
static_assert(sizeof(std::array<std::uint16_t, 3>) == 3 * sizeof(std::uint16_t));

const float* Floats(const std::vector<protocol::Vector3>& vectors) {
  return vectors.empty() ? nullptr : &vectors.front().x;
}

template <std::size_t count>
const std::uint16_t* Numbers(const std::vector<std::array<std::uint16_t, count>>& tuples) {
  return tuples.empty() ? nullptr : tuples.front().data();
}

void CopyFloats(const std::vector<protocol::Vector3>& from, float* to) {
  if (!from.empty()) std::memcpy(to, from.data(), from.size() * sizeof from[0]);
}

bool AreSame(const client::BodySample& a, const client::BodySample& b) {
  return a.blueprint == b.blueprint && a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof a.vertices[0]) == 0;
}

bool HaveSameLayout(const std::vector<client::BodySample>& a, const std::vector<client::BodySample>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.body == y.body && x.blueprint == y.blueprint; });
}

}  // namespace

void Frames::Take(client::Client& client, double now) {
  const Frame& before = Newest();
  Frame& frame = m_frames[1 - m_newest];
  client.Sample(now, client::Detail::kVertices, frame.samples);
  frame.skins.resize(frame.samples.size());
  frame.vertexCount = frame.indexCount = 0;
  std::size_t old = 0;  // both samples ascend
  for (std::size_t i = 0; i < frame.samples.size(); ++i) {
    const client::BodySample& sample = frame.samples[i];
    Skin& skin = frame.skins[i];
    while (old < before.samples.size() && before.samples[old].body < sample.body) ++old;
    const bool isOld = old < before.samples.size() && before.samples[old].body == sample.body;
    skin.changed = !isOld || !AreSame(before.samples[old], sample);
    if (skin.changed) {
      skin.normals.resize(sample.vertices.size());
      client::FindNormals(sample.vertices, sample.blueprint->faces, skin.normals);
    } else {
      skin.normals = before.skins[old].normals;
    }
    skin.firstVertex = frame.vertexCount;
    skin.firstIndex = frame.indexCount;
    frame.vertexCount += static_cast<std::uint32_t>(sample.vertices.size());
    frame.indexCount += static_cast<std::uint32_t>(3 * sample.blueprint->faces.size());
  }
  frame.layout = before.layout + (HaveSameLayout(before.samples, frame.samples) ? 0 : 1);
  m_newest = 1 - m_newest;  // last: when memory runs out, the last sample is as it was
}

bool Frames::CopyTo(wobble_frame& to) const {
  const Frame& frame = Newest();
  to.body_count = static_cast<std::uint32_t>(frame.samples.size());
  to.vertex_count = frame.vertexCount;
  to.index_count = frame.indexCount;
  to.layout = frame.layout;
  const bool needsVertices = to.positions != nullptr || to.normals != nullptr;
  if (needsVertices && to.vertex_capacity < frame.vertexCount) return false;
  if (to.indices != nullptr && to.index_capacity < frame.indexCount) return false;
  for (std::size_t i = 0; i < frame.samples.size(); ++i) {
    const client::BodySample& sample = frame.samples[i];
    const Skin& skin = frame.skins[i];
    if (to.positions != nullptr) CopyFloats(sample.vertices, to.positions + std::size_t{3} * skin.firstVertex);
    if (to.normals != nullptr) CopyFloats(skin.normals, to.normals + std::size_t{3} * skin.firstVertex);
    if (to.indices == nullptr) continue;
    std::uint32_t* next = to.indices + skin.firstIndex;
    for (const auto& face : sample.blueprint->faces) {
      for (const std::uint16_t corner : face) *next++ = skin.firstVertex + corner;
    }
  }
  return true;
}

std::optional<wobble_body> Frames::Find(std::uint32_t index) const {
  const Frame& frame = Newest();
  if (index >= frame.samples.size()) return {};
  const client::BodySample& sample = frame.samples[index];
  const client::Blueprint& blueprint = *sample.blueprint;
  const Skin& skin = frame.skins[index];
  const auto& [centroid, rotation] = sample.pose;
  return wobble_body{.struct_size = 0,
                     .body = sample.body,
                     .first_vertex = skin.firstVertex,
                     .first_index = skin.firstIndex,
                     .vertex_count = static_cast<std::uint32_t>(sample.vertices.size()),
                     .face_count = static_cast<std::uint32_t>(blueprint.faces.size()),
                     .edge_count = static_cast<std::uint32_t>(blueprint.edges.size()),
                     .changed = skin.changed ? 1 : 0,
                     .held = sample.held ? 1 : 0,
                     .open = blueprint.open ? 1 : 0,
                     .age = static_cast<float>(sample.age),
                     .centroid = {centroid.x, centroid.y, centroid.z},
                     .rotation = {rotation.w, rotation.x, rotation.y, rotation.z},
                     .blueprint = blueprint.name.c_str(),
                     .positions = Floats(sample.vertices),
                     .normals = Floats(skin.normals),
                     .faces = Numbers(blueprint.faces),
                     .edges = Numbers(blueprint.edges),
                     .lead = {sample.lead.x, sample.lead.y, sample.lead.z},
                     .reserved = 0};
}

const client::Blueprint* Frames::FindBlueprint(std::uint32_t body) const {
  const auto& samples = Newest().samples;
  const auto found =
      std::lower_bound(samples.begin(), samples.end(), body,
                       [](const client::BodySample& sample, std::uint32_t sought) { return sample.body < sought; });
  return found == samples.end() || found->body != body ? nullptr : found->blueprint.get();
}

}  // namespace wobble::c
