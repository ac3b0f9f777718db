// Blueprints on their way in, and those that are here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "client/client.h"

namespace wobble::client {

class BlueprintStore {
 public:
  // As many as the welcome promised; once.
  void Expect(std::size_t count);

  // Takes a chunk that ParseServerMessage has passed. False when it does not belong: no such blueprint, one that is
  // complete, a gap, another total or hash than before, or a whole that is not what its hash or its limits say. What
  // had come of that blueprint is then dropped; it may start again from its first byte.
  [[nodiscard]] bool AddChunk(const wire::BlueprintChunk& chunk);

  [[nodiscard]] bool Complete() const { return m_complete == m_entries.size(); }
  // nullptr while it is not all here. Stays where it is for the life of the store.
  [[nodiscard]] const Blueprint* Find(std::size_t index) const {
    return index < m_entries.size() ? m_entries[index].blueprint.get() : nullptr;
  }

 private:
  struct Entry {
    std::unique_ptr<Blueprint> blueprint;
    std::vector<std::uint8_t> bytes;  // until it is complete; grows with what arrives, not with what is announced
    std::uint32_t total = 0;
    std::uint64_t hash = 0;
  };

  std::vector<Entry> m_entries;
  std::size_t m_complete = 0;
};

}  // namespace wobble::client
