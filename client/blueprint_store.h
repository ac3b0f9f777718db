// The blueprints of a world: puts them together from their chunks and keeps the newest of each number.
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

  // The number that the welcome promises; to be called once. More may follow.
  void Expect(std::size_t count);

  // Takes a chunk that ParseServerMessage has passed. False when it is out of place: before Expect, a number out of
  // range, a generation that is complete, a gap, another total or hash than before, or a whole that contradicts its
  // hash or limits. The bytes of that generation are then dropped; it may start again from its first byte.
  [[nodiscard]] bool AddChunk(const wire::BlueprintChunk& chunk);

  // Whether each blueprint of the welcome has been complete once.
  [[nodiscard]] bool Complete() const { return m_missing == 0; }
  // nullptr while it is incomplete, or when the number means a blueprint of another generation.
  [[nodiscard]] std::shared_ptr<const Blueprint> Find(std::size_t index, unsigned generation) const {
    const bool known = index < m_entries.size() && m_entries[index].generation == generation;
    return known ? m_entries[index].blueprint : nullptr;
  }

 private:
  struct Entry {
    std::shared_ptr<const Blueprint> blueprint;
    unsigned generation = 0;
    // Of the blueprint that is arriving. Memory grows with the bytes that arrive, not with the total announced.
    std::vector<std::uint8_t> bytes;
    std::uint32_t total = 0;
    std::uint64_t hash = 0;
    unsigned nextGeneration = 0;
  };

  std::vector<Entry> m_entries;
  std::size_t m_expected = 0;
  std::size_t m_missing = 0;  // of the expected ones
  bool m_expects = false;
  bool m_readsBases;
};

}  // namespace wobble::client
