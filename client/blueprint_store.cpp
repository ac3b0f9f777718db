// The control channel is reliable and ordered, so an honest server's chunks of one blueprint come one after the other,
// each where the last ended; anything else is refused instead of being pieced together. What a hostile server can make
// a client hold is kMaxBlueprints × kMaxBlueprintBytes, and it has to send every byte of it.
#include "client/blueprint_store.h"

#include <cassert>
#include <cmath>

namespace wobble::client {
namespace {

// Not in the world, or not a number.
bool IsOutside(float coordinate) { return !(std::fabs(coordinate) <= static_cast<float>(protocol::kWorldHalfExtent)); }

// nullptr when it is not a blueprint that anything could be drawn from.
std::unique_ptr<Blueprint> MakeBlueprint(const std::vector<std::uint8_t>& bytes) {
  const wire::Blueprint* source = nullptr;
  if (protocol::ParseBlueprint(bytes, source) != protocol::ParseResult::kOk || IsOutside(source->size()))
    return nullptr;
  auto blueprint = std::make_unique<Blueprint>();
  blueprint->name = source->name()->str();
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
  return blueprint;
}

}  // namespace

void BlueprintStore::Expect(std::size_t count) {
  assert(m_entries.empty() && count <= protocol::kMaxBlueprints);
  m_entries.resize(count);
}

bool BlueprintStore::AddChunk(const wire::BlueprintChunk& chunk) {
  if (chunk.blueprint() >= m_entries.size()) return false;
  Entry& entry = m_entries[chunk.blueprint()];
  if (entry.blueprint != nullptr) return false;
  if (entry.bytes.empty()) {
    entry.total = chunk.total();
    entry.hash = chunk.hash();
  }
  const bool follows =
      chunk.offset() == entry.bytes.size() && chunk.total() == entry.total && chunk.hash() == entry.hash;
  if (follows) entry.bytes.insert(entry.bytes.end(), chunk.bytes()->begin(), chunk.bytes()->end());
  if (follows && entry.bytes.size() < entry.total) return true;

  if (follows && protocol::HashBytes(entry.bytes) == entry.hash) entry.blueprint = MakeBlueprint(entry.bytes);
  entry.bytes = {};
  if (entry.blueprint == nullptr) return false;
  ++m_complete;
  return true;
}

}  // namespace wobble::client
