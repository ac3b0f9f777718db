// Captures of the world's bodies, made on demand: a body is captured when its vertices are asked for, and again only
// after it has moved.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "server/physics/world.h"
#include "server/snapshots/capture.h"

namespace wobble::server {

// A body that clients may be shown, with what the choice among bodies needs to know.
struct ShownBody {
  std::uint32_t body = 0;
  protocol::Vector3 centre;    // m, to within the size of the body
  float speed = 0;             // of the centre, m/s
  std::uint32_t restTick = 0;  // the tick at which it fell asleep; 0: it is awake
  std::uint8_t blueprint = 0;  // its slot
  float size = 1;              // of its blueprint, m
};

// Brings per-body data in line with the bodies that exist now: drops the entries of removed bodies and appends entries
// for new ones. Both lists ascend by id and ids are never reused, so the entries that stay begin the new list.
// Kept: default-constructible, with a member `body`.
template <class Kept>
void FollowBodies(std::span<const ShownBody> bodies, std::vector<Kept>& kept) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (next == bodies.size() || kept[i].body != bodies[next].body) continue;
    if (next != i) kept[next] = std::move(kept[i]);
    ++next;
  }
  kept.resize(next);
  kept.resize(bodies.size());
  for (; next < bodies.size(); ++next) kept[next].body = bodies[next].body;
}

// Finds the entry of a body in a list that ascends by id; null when there is none. O(log n).
template <class Kept>
[[nodiscard]] Kept* FindBody(std::span<Kept> kept, std::uint32_t body) {
  const auto found = std::lower_bound(kept.begin(), kept.end(), body,
                                      [](const Kept& each, std::uint32_t wanted) { return each.body < wanted; });
  return found != kept.end() && found->body == body ? &*found : nullptr;
}

class BodyCaptures {
 public:
  // Notes which bodies are new, gone or moved. Call it after every step of the world, and after it was restored. tick:
  // as clients are told it, never backwards. O(stepped bodies).
  void Follow(const physics::World& world, std::uint32_t tick);

  // All bodies of the world as of the last Follow, by ascending id.
  [[nodiscard]] std::span<const ShownBody> Bodies() const { return m_shown; }
  // CapturedBody::version of Bodies()[index]; 0 when there is no capture of its present state.
  [[nodiscard]] std::uint64_t Version(std::size_t index) const {
    return m_moved[index] != 0 ? 0 : m_captured[index].version;
  }
  // The capture of Bodies()[index], made now if the body has moved since the last one. world: as of the last Follow.
  const CapturedBody& Read(const physics::World& world, std::size_t index);

 private:
  void DropRemoved(const physics::World& world);
  void TakeRestored(const physics::World& world, std::uint32_t tick);

  std::vector<ShownBody> m_shown;
  std::vector<CapturedBody> m_captured;
  std::vector<std::uint8_t> m_moved;  // 1: it has moved since its last capture
  std::uint64_t m_removals = 0;       // WorldChanges::removals at the last Follow
  std::uint64_t m_restores = 0;       // WorldChanges::restores at the last Follow
};

}  // namespace wobble::server
