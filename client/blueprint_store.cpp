// The control channel is reliable and ordered, so an honest server's chunks of one blueprint come one after the other,
// each beginning where the last ended, or at 0 when the blueprint has changed meanwhile; anything else is refused
// rather than pieced together. A hostile server can make a client hold at most twice kMaxBlueprints ×
// kMaxBlueprintBytes, and must send every byte of it. Replaced blueprints live on in bodies alone, whose vertices are
// counted.
#include "client/blueprint_store.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "protocol/codec/basis_reader.h"
#include "protocol/heap_sort.h"
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
  protocol::HeapSort(edges);
  return std::any_of(edges.begin(), edges.end(), [&](std::uint32_t edge) {
    return !std::binary_search(edges.begin(), edges.end(), edge << 16U | edge >> 16U);
  });
}

// Without bases. nullptr when the bytes are no valid blueprint, or one with coordinates outside the world.
std::shared_ptr<Blueprint> MakeBlueprint(std::span<const std::uint8_t> bytes) {
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

void BlueprintStore::ForgetScene() {
  m_entries.clear();
  m_awaited.clear();
  m_expects = false;
}

std::deque<BlueprintStore::Awaited>::iterator BlueprintStore::FindAwaited(std::size_t number) {
  return std::find_if(m_awaited.begin(), m_awaited.end(), [&](const Awaited& each) { return each.number == number; });
}

bool BlueprintStore::Await(const wire::BlueprintChunk& chunk, std::vector<std::uint8_t> bytes,
                           std::uint32_t takenBefore) {
  if (protocol::HashBytes(bytes) != chunk.hash()) return false;
  std::shared_ptr<Blueprint> whole = MakeBlueprint(bytes);
  if (whole == nullptr) return false;
  m_awaited.push_back({.number = chunk.blueprint(),
                       .generation = chunk.generation(),
                       .hash = chunk.hash(),
                       .isDownloaded = chunk.bytes()->size() > 0,
                       .takenBefore = takenBefore,
                       .bytes = std::move(bytes),
                       .blueprint = std::move(whole),
                       .reader = {}});
  return true;
}

BlueprintStore::Step BlueprintStore::CompleteNext(Awaited& awaited, std::size_t& work) const {
  const wire::Blueprint& source = *flatbuffers::GetRoot<wire::Blueprint>(awaited.bytes.data());  // parsed in Await
  std::vector<protocol::PatchConstants>& patches = awaited.blueprint->patches;
  // ParseBlueprint has seen to it that there is one basis a patch, or none.
  if (!m_readsBases || source.bases() == nullptr || awaited.patch == patches.size()) return Step::kComplete;
  if (!awaited.reader) {
    const auto& bytes = *source.bases()->Get(static_cast<flatbuffers::uoffset_t>(awaited.patch))->bytes();
    awaited.reader.emplace(std::span(bytes.data(), bytes.size()),
                           protocol::PatchSize(awaited.blueprint->rest.size(), awaited.patch));
  }
  while (work > 0) {
    const std::size_t done = awaited.reader->Step();
    work -= std::min(done, work);
    if (done > 0) continue;
    patches[awaited.patch].basis = awaited.reader->Take();
    awaited.reader.reset();
    return patches[awaited.patch++].basis != nullptr ? Step::kWorking : Step::kBad;
  }
  return Step::kWorking;
}

unsigned BlueprintStore::Complete(std::size_t& work, const OnDownload& onDownload) {
  unsigned dropped = 0;
  while (!m_awaited.empty() && work > 0) {
    Awaited& awaited = m_awaited.front();
    const Step step = CompleteNext(awaited, work);
    if (step == Step::kWorking) continue;
    if (step == Step::kComplete) {
      Entry& entry = m_entries[awaited.number];
      entry.blueprint = std::move(awaited.blueprint);
      entry.generation = awaited.generation;
      if (awaited.isDownloaded && onDownload) onDownload(awaited.hash, awaited.bytes);
    } else {
      ++dropped;
    }
    m_awaited.pop_front();
  }
  return dropped;
}

bool BlueprintStore::AddChunk(const wire::BlueprintChunk& chunk) {
  if (!m_expects) return false;
  // Counted whatever becomes of it: the count tells the server what is no longer on its way.
  const std::uint32_t takenBefore = m_taken;
  const bool isKept = chunk.bytes()->size() == 0;
  m_taken += isKept ? protocol::kKeptPieceBytes : chunk.bytes()->size();
  if (chunk.blueprint() >= protocol::kMaxBlueprints) return false;
  const bool isFirst = chunk.offset() == 0 || isKept;
  if (chunk.blueprint() >= m_entries.size()) {
    if (!isFirst) return false;
    m_entries.resize(std::size_t{chunk.blueprint()} + 1);
  }
  Entry& entry = m_entries[chunk.blueprint()];
  if (isFirst) {  // the server has begun anew: the blueprint changed while it was on its way
    entry.bytes = {};
    const auto awaited = FindAwaited(chunk.blueprint());
    const bool isAwaited = awaited != m_awaited.end() && awaited->generation == chunk.generation();
    if (isAwaited || (entry.blueprint != nullptr && entry.generation == chunk.generation())) return false;
    if (awaited != m_awaited.end()) m_awaited.erase(awaited);
    entry.total = chunk.total();
    entry.hash = chunk.hash();
    entry.nextGeneration = chunk.generation();
  }
  if (isKept) {
    const KeptBlueprint* kept = FindKept(chunk.hash());
    return kept != nullptr && Await(chunk, kept->bytes, takenBefore);
  }
  const bool follows = chunk.offset() == entry.bytes.size() && chunk.total() == entry.total &&
                       chunk.hash() == entry.hash && chunk.generation() == entry.nextGeneration;
  if (follows) entry.bytes.insert(entry.bytes.end(), chunk.bytes()->begin(), chunk.bytes()->end());
  if (follows && entry.bytes.size() < entry.total) return true;
  std::vector<std::uint8_t> whole = std::move(entry.bytes);
  entry.bytes = {};
  return follows && Await(chunk, std::move(whole), takenBefore);
}

}  // namespace wobble::client
