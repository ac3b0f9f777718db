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
  // readsBases: false for a client that decodes no shapes; its blueprints then have none. kept: from earlier
  // connections; may be null.
  BlueprintStore(bool readsBases, std::shared_ptr<const KeptBlueprints> kept);

  // For the hello, at most protocol::kMaxKeptBlueprints.
  [[nodiscard]] std::span<const std::uint64_t> KeptHashes() const { return m_keptHashes; }

  // The number that the welcome promises; to be called once. More may follow.
  void Expect(std::size_t count);

  // What a chunk has done. kWhole: a blueprint that was downloaded is complete; NewestBytes are its bytes.
  enum class Progress : std::uint8_t { kRefused, kTaken, kWhole };
  // Takes a chunk that ParseServerMessage has passed. A chunk with offset 0 begins anew. Refuses what is out of place:
  // before Expect, a number out of range, the generation in force, a gap, another total or hash than before, a whole
  // that contradicts its hash or limits, or a kept blueprint that is not there. The bytes of that generation are then
  // dropped; it may start again from its first byte.
  [[nodiscard]] Progress AddChunk(const wire::BlueprintChunk& chunk);
  [[nodiscard]] std::span<const std::uint8_t> NewestBytes() const { return m_newestBytes; }

  // Whether a blueprint of this number has been complete once.
  [[nodiscard]] bool Has(std::size_t index) const {
    return index < m_entries.size() && m_entries[index].blueprint != nullptr;
  }
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

  // Puts the blueprint of these bytes in force, if they are one. entry: whose chunk this is.
  [[nodiscard]] bool PutInForce(Entry& entry, const wire::BlueprintChunk& chunk, std::span<const std::uint8_t> bytes);
  [[nodiscard]] const KeptBlueprint* FindKept(std::uint64_t hash) const;

  std::vector<Entry> m_entries;
  bool m_expects = false;
  bool m_readsBases;
  std::shared_ptr<const KeptBlueprints> m_kept;
  std::vector<std::uint64_t> m_keptHashes;
  std::vector<std::uint8_t> m_newestBytes;
};

}  // namespace wobble::client
