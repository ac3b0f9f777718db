// The control channel is reliable and ordered, so an honest server's chunks of one blueprint come one after the other,
// each beginning where the last ended, or at 0 when the blueprint has changed meanwhile; anything else is refused
// rather than pieced together. A hostile server can make a client hold at most twice kMaxBlueprints ×
// kMaxBlueprintBytes, and must send every byte of it. Replaced blueprints live on in bodies alone, whose vertices are
// counted.
#include "client/blueprint_store.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "protocol/snapshot.h"
#include "protocol/text.h"

namespace wobble::client {
namespace {

// True also for NaN.
bool IsOutside(float coordinate) { return !(std::fabs(coordinate) <= static_cast<float>(protocol::kWorldHalfExtent)); }

// Whether some edge has a face on one side only.
bool IsOpen(const std::vector<std::array<std::uint16_t, 3>>& faces) {
  std::vector<std::uint32_t> edges;  // from · 2¹⁶ + to, in the order of each face's corners
  for (const auto& face : faces) {
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::uint32_t{face[i]} << 16U | face[(i + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  return std::any_of(edges.begin(), edges.end(), [&](std::uint32_t edge) {
    return !std::binary_search(edges.begin(), edges.end(), edge << 16U | edge >> 16U);
  });
}

bool ReadBases(const wire::Blueprint& source, Blueprint& blueprint) {
  if (source.bases() == nullptr) return true;
  std::size_t patch = 0;  // ParseBlueprint has seen to it that there is one basis a patch
  for (const wire::Basis* basis : *source.bases()) {
    const std::span bytes(basis->bytes()->data(), basis->bytes()->size());
    const std::shared_ptr<const protocol::Basis> read =
        protocol::ReadBasis(bytes, protocol::PatchSize(blueprint.rest.size(), patch));
    if (read == nullptr) return false;
    blueprint.patches[patch++].basis = read;
  }
  return true;
}

// nullptr when the bytes are no valid blueprint, or one with coordinates outside the world.
std::shared_ptr<const Blueprint> MakeBlueprint(std::span<const std::uint8_t> bytes, bool readsBases) {
  const wire::Blueprint* source = nullptr;
  if (protocol::ParseBlueprint(bytes, source) != protocol::ParseResult::kOk || IsOutside(source->size()))
    return nullptr;
  auto blueprint = std::make_shared<Blueprint>();
  blueprint->name = protocol::MakeLine(source->name()->string_view(), protocol::kMaxShownBytes);
  blueprint->size = source->size();
  blueprint->rest.reserve(source->rest()->size());
  for (const wire::Vec3* v : *source->rest()) {
    if (IsOutside(v->x()) || IsOutside(v->y()) || IsOutside(v->z())) return nullptr;
    blueprint->rest.push_back({v->x(), v->y(), v->z()});
  }
  blueprint->faces.reserve(source->faces()->size());
  for (const wire::Face* face : *source->faces()) {
    blueprint->faces.push_back({face->a(), face->b(), face->c()});
  }
  blueprint->open = IsOpen(blueprint->faces);
  if (source->edges() != nullptr) {
    blueprint->edges.reserve(source->edges()->size());
    for (const wire::Edge* edge : *source->edges()) blueprint->edges.push_back({edge->a(), edge->b()});
  }
  if (source->particles() != nullptr) {
    for (const wire::ParticleTag* tag : *source->particles()) blueprint->particles.push_back(*tag);
  }
  if (source->springs() != nullptr) {
    for (const wire::SpringTag* tag : *source->springs()) blueprint->springs.push_back(*tag);
  }
  blueprint->patches = protocol::FindPatchConstants(blueprint->rest);
  if (readsBases && !ReadBases(*source, *blueprint)) return nullptr;
  return blueprint;
}

}  // namespace

BlueprintStore::BlueprintStore(bool readsBases, std::shared_ptr<const KeptBlueprints> kept)
    : m_readsBases(readsBases), m_kept(std::move(kept)) {
  if (m_kept == nullptr) return;
  std::size_t bytes = 0;
  for (const KeptBlueprint& blueprint : *m_kept) {
    bytes += blueprint.bytes.size();
    if (bytes > protocol::kMaxKeptBytes || m_keptHashes.size() == protocol::kMaxKeptBlueprints) break;
    m_keptHashes.push_back(blueprint.hash);
  }
}

const KeptBlueprint* BlueprintStore::FindKept(std::uint64_t hash) const {
  if (m_kept == nullptr) return nullptr;
  const auto found =
      std::find_if(m_kept->begin(), m_kept->end(), [&](const KeptBlueprint& each) { return each.hash == hash; });
  return found == m_kept->end() ? nullptr : &*found;
}

void BlueprintStore::Expect(std::size_t count) {
  assert(!m_expects && count <= protocol::kMaxBlueprints);
  m_entries.resize(count);
  m_expects = true;
}

bool BlueprintStore::PutInForce(Entry& entry, const wire::BlueprintChunk& chunk, std::span<const std::uint8_t> bytes) {
  if (protocol::HashBytes(bytes) != chunk.hash()) return false;
  std::shared_ptr<const Blueprint> whole = MakeBlueprint(bytes, m_readsBases);
  if (whole == nullptr) return false;
  entry.blueprint = std::move(whole);
  entry.generation = chunk.generation();
  return true;
}

BlueprintStore::Progress BlueprintStore::AddChunk(const wire::BlueprintChunk& chunk) {
  if (!m_expects || chunk.blueprint() >= protocol::kMaxBlueprints) return Progress::kRefused;
  const bool isKept = chunk.bytes()->size() == 0;
  const bool isFirst = chunk.offset() == 0 || isKept;
  if (chunk.blueprint() >= m_entries.size()) {
    if (!isFirst) return Progress::kRefused;
    m_entries.resize(std::size_t{chunk.blueprint()} + 1);
  }
  Entry& entry = m_entries[chunk.blueprint()];
  if (isFirst) {  // the server has begun anew: the blueprint changed while it was on its way
    entry.bytes = {};
    if (entry.blueprint != nullptr && entry.generation == chunk.generation()) return Progress::kRefused;
    entry.total = chunk.total();
    entry.hash = chunk.hash();
    entry.nextGeneration = chunk.generation();
  }
  if (isKept) {
    const KeptBlueprint* kept = FindKept(chunk.hash());
    return kept != nullptr && PutInForce(entry, chunk, kept->bytes) ? Progress::kTaken : Progress::kRefused;
  }
  const bool follows = chunk.offset() == entry.bytes.size() && chunk.total() == entry.total &&
                       chunk.hash() == entry.hash && chunk.generation() == entry.nextGeneration;
  if (follows) entry.bytes.insert(entry.bytes.end(), chunk.bytes()->begin(), chunk.bytes()->end());
  if (follows && entry.bytes.size() < entry.total) return Progress::kTaken;
  m_newestBytes = std::move(entry.bytes);
  entry.bytes = {};
  return follows && PutInForce(entry, chunk, m_newestBytes) ? Progress::kWhole : Progress::kRefused;
}

}  // namespace wobble::client
