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
  // readsBases: false for a client that decodes no shapes; its blueprints then have none.
  explicit BlueprintStore(bool readsBases) : m_readsBases(readsBases) {}

  // As many as the welcome promised; once. More may follow.
  void Expect(std::size_t count);

  // Takes a chunk that ParseServerMessage has passed. False when it does not belong: before Expect, no such number, a
  // generation that is complete, a gap, another total or hash than before, or a whole that is not what its hash or its
  // limits say. What had come of that generation is then dropped; it may start again from its first byte.
  [[nodiscard]] bool AddChunk(const wire::BlueprintChunk& chunk);

  // All that were expected have been here once.
  [[nodiscard]] bool Complete() const { return m_missing == 0; }
  // nullptr while it is not all here, or when the number means a blueprint of another generation by now.
  [[nodiscard]] std::shared_ptr<const Blueprint> Find(std::size_t index, unsigned generation) const {
    const bool known = index < m_entries.size() && m_entries[index].generation == generation;
    return known ? m_entries[index].blueprint : nullptr;
  }

 private:
  struct Entry {
    std::shared_ptr<const Blueprint> blueprint;
    unsigned generation = 0;
    // Of the one that is on its way; grows with what arrives, not with what is announced.
    std::vector<std::uint8_t> bytes;
    std::uint32_t total = 0;
    std::uint64_t hash = 0;
    unsigned nextGeneration = 0;
  };

  std::vector<Entry> m_entries;
  std::size_t m_expected = 0;
  std::size_t m_missing = 0;  // of those
  bool m_expects = false;
  bool m_readsBases;
};

}  // namespace wobble::client
