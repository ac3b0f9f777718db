// A slot whose content changes gets the next generation, which every record carries, so that a client never decodes a
// record with another blueprint than the one that it was encoded with.
#include "server/snapshots/blueprint_captures.h"

#include "protocol/limits.h"

namespace wobble::server {

std::span<const std::uint8_t> BlueprintCaptures::Follow(const physics::World& world, const Workshop* workshop) {
  m_news.clear();
  const physics::WorldChanges changes = world.Changes();
  if (m_revision == changes.blueprintRevision) return m_news;
  m_revision = changes.blueprintRevision;
  const std::span<const physics::Blueprint> present = world.Blueprints();
  for (std::size_t slot = 0; slot < present.size(); ++slot) {
    const auto number = static_cast<std::uint8_t>(slot);
    const bool isNew = slot == m_blueprints.size();
    if (!isNew && m_blueprints[slot].revision == changes.slots[slot].revision) continue;
    const bool isWorkshop = workshop != nullptr && world.ReadBody(workshop->Body()).blueprint == number;
    const BlueprintTags tags =
        isWorkshop ? CaptureTags(present[slot], workshop->Particles(), workshop->Springs()) : BlueprintTags{};
    CapturedBlueprint fresh = CaptureBlueprint(present[slot], FindBases(world, slot), tags);
    fresh.revision = changes.slots[slot].revision;
    if (isNew) {
      m_blueprints.emplace_back();
    } else {
      const CapturedBlueprint& old = m_blueprints[slot];
      const bool isSame = fresh.hash == old.hash;
      fresh.generation =
          isSame ? old.generation : static_cast<std::uint8_t>((old.generation + 1) % protocol::kGenerations);
    }
    const bool isKnown = !isNew && fresh.generation == m_blueprints[slot].generation;
    m_blueprints[slot] = std::move(fresh);
    if (!isKnown) m_news.push_back(number);
  }
  return m_news;
}

// A blueprint that appears after the start takes the bases of a scene blueprint with the same rest shape and the same
// grid, if these are small. A cloth that tears changes its blueprint several times a second: it keeps its cosine basis
// (a few bytes), but a trained basis of up to 64 KB would go to every client with each torn spring.
const Bases& BlueprintCaptures::FindBases(const physics::World& world, std::size_t slot) const {
  static const Bases kNone;
  constexpr std::size_t kSmall = 8 * 1024;  // bytes
  if (slot < m_bases.size()) return m_bases[slot];
  const std::span<const physics::Blueprint> present = world.Blueprints();
  const auto isLike = [&](const physics::Blueprint& other) {
    return other.rest == present[slot].rest && other.grid.CountVertices() == present[slot].grid.CountVertices();
  };
  for (std::size_t i = 0; i < m_bases.size(); ++i) {
    std::size_t bytes = 0;
    for (const auto& basis : m_bases[i]) bytes += basis.size();
    if (bytes <= kSmall && isLike(present[i])) return m_bases[i];
  }
  return kNone;
}

}  // namespace wobble::server
