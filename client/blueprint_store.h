// The blueprints of a world: puts them together from their chunks and keeps the newest of each number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "client/client.h"
#include "protocol/codec/basis_reader.h"

namespace wobble::client {

class BlueprintStore {
 public:
  // readsBases: false for a client that decodes no shapes; its blueprints then have none. kept: from earlier
  // connections; may be null.
  BlueprintStore(bool readsBases, std::shared_ptr<const KeptBlueprints> kept);

  // For the hello, at most protocol::kMaxKeptBlueprints.
  [[nodiscard]] std::span<const std::uint64_t> KeptHashes() const { return m_keptHashes; }

  // The number that the welcome promises; to be called once for each scene. More may follow.
  void Expect(std::size_t count);
  // Another scene follows: drops its blueprints, and counts on what has been taken.
  void ForgetScene();

  // Takes a chunk that ParseServerMessage has passed. A chunk with offset 0 begins anew. Refuses (false) what is out of
  // place: before Expect, a number out of range, the generation in force, a gap, another total or hash than before, a
  // whole that contradicts its hash or limits, or a kept blueprint that is not there. The bytes of that generation are
  // then dropped; it may start again from its first byte.
  [[nodiscard]] bool AddChunk(const wire::BlueprintChunk& chunk);

  // Completes bases of the blueprints that have come whole, in the order in which they came: about `work`
  // multiplications, so that a program that draws is not held up, of which the rest stays. A blueprint with its last
  // basis is in force. onDownload: is then called with its hash and bytes if it was downloaded. Returns the number of
  // blueprints that had to be dropped for a bad basis.
  using OnDownload = std::function<void(std::uint64_t hash, std::span<const std::uint8_t> bytes)>;
  unsigned Complete(std::size_t& work, const OnDownload& onDownload);

  [[nodiscard]] bool IsCompleting() const { return !m_awaited.empty(); }

  // Bytes of the chunks up to the first whose blueprint is whole and not in force yet; modulo 2^32. The server sends
  // bodies at rest once it knows by this that they can be decoded.
  [[nodiscard]] std::uint32_t CountTaken() const { return m_awaited.empty() ? m_taken : m_awaited.front().takenBefore; }
  // Counts bytes that are no chunk's, of heights.
  void CountOther(std::uint32_t bytes) { m_taken += bytes; }

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

  // A blueprint that is whole and whose bases are being completed.
  struct Awaited {
    std::size_t number = 0;
    unsigned generation = 0;
    std::uint64_t hash = 0;
    bool isDownloaded = false;
    std::uint32_t takenBefore = 0;  // bytes, before its last chunk
    std::vector<std::uint8_t> bytes;
    std::shared_ptr<Blueprint> blueprint;
    std::size_t patch = 0;  // whose basis is being completed
    std::optional<protocol::BasisReader> reader;
  };

  // Takes the chunk's blueprint for whole, if these bytes are one.
  [[nodiscard]] bool Await(const wire::BlueprintChunk& chunk, std::vector<std::uint8_t> bytes,
                           std::uint32_t takenBefore);
  [[nodiscard]] std::deque<Awaited>::iterator FindAwaited(std::size_t number);
  enum class Step : std::uint8_t { kWorking, kComplete, kBad };
  [[nodiscard]] Step CompleteNext(Awaited& awaited, std::size_t& work) const;
  [[nodiscard]] const KeptBlueprint* FindKept(std::uint64_t hash) const;

  std::vector<Entry> m_entries;
  bool m_expects = false;
  bool m_readsBases;
  std::shared_ptr<const KeptBlueprints> m_kept;
  std::vector<std::uint64_t> m_keptHashes;
  std::deque<Awaited> m_awaited;
  std::uint32_t m_taken = 0;  // bytes
};

}  // namespace wobble::client
