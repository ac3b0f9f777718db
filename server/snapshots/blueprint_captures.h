// The blueprints of the world as clients know them, kept in line with the world while players tear and build.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/world.h"
#include "server/play/workshop.h"
#include "server/snapshots/capture.h"

namespace wobble::server {

class BlueprintCaptures {
 public:
  // bases: of the scene's blueprints, in their order; may be shorter or empty.
  explicit BlueprintCaptures(std::vector<Bases> bases) : m_bases(std::move(bases)) {}

  // Captures the blueprints that the world has added or changed since the last call. workshop: null when the scene has
  // none. Returns the slots whose content is new to clients, ascending, valid until the next call; a slot that changed
  // back to the same content is not among them.
  std::span<const std::uint8_t> Follow(const physics::World& world, const Workshop* workshop);

  // By slot; the slot is the blueprint's number on the wire.
  [[nodiscard]] std::span<const CapturedBlueprint> All() const { return m_blueprints; }
  [[nodiscard]] const CapturedBlueprint& operator[](std::size_t slot) const { return m_blueprints[slot]; }

 private:
  [[nodiscard]] const Bases& FindBases(const physics::World& world, std::size_t slot) const;

  std::vector<Bases> m_bases;
  std::vector<CapturedBlueprint> m_blueprints;
  std::vector<std::uint8_t> m_news;  // what Follow returns
  std::uint64_t m_revision = 0;      // World::BlueprintRevision at the last Follow
};

}  // namespace wobble::server
