// Encodes captured bodies into records, once for all clients.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "server/snapshots/body_captures.h"
#include "server/snapshots/capture.h"

namespace wobble::physics {
class Threads;
}

namespace wobble::server {

// A body's records, one per patch, as bytes that are copied into packets.
using Records = std::span<const std::span<const std::uint8_t>>;

// The qualities of a snapshot, finest first: the RMS error over a body's vertices, as a share of its size. The coarser
// ones are for distant bodies and for clients whose byte budget would leave bodies out (coarseness.h). In steps of the
// root of two up to what one sees from near, so that a budget is used well, then of two.
inline constexpr std::array<float, 7> kSnapshotErrorShares{0.0025F, 0.0035F, 0.005F, 0.007F, 0.01F, 0.02F, 0.04F};
inline constexpr std::size_t kQualities = kSnapshotErrorShares.size();

struct EncodedBody {
  Records records;
  std::uint32_t vertices = 0;  // in the records
  double errorSquares = 0;     // (error / size)², summed over these vertices
  double error = 0;            // root of their mean
};

// One body encoded at one quality.
struct Encoding {
  std::uint64_t version = 0;        // of the capture that it was made from; 0: not encoded yet
  std::vector<std::uint8_t> bytes;  // of all records
  std::vector<std::size_t> ends;    // where each record ends in them
  std::vector<std::span<const std::uint8_t>> records;
  EncodedBody body;
  // The tick of its last read, and of the read in an earlier tick; 0: none.
  std::uint32_t lastRead = 0;
  std::uint32_t readBefore = 0;
};

// A captured body that is to be encoded ahead. index: in the list that Encoder::Follow was given.
struct FreshCapture {
  std::size_t index = 0;
  const CapturedBody* body = nullptr;
  const CapturedBlueprint* blueprint = nullptr;
};

class Encoder {
 public:
  // obstacles: as clients have them from the welcome; records are predicted from contact with these. threads: 1 or
  // more.
  explicit Encoder(std::vector<protocol::wire::Obstacle> obstacles = {}, int threads = 1);
  ~Encoder();

  // Drops removed bodies and adds new ones. bodies: all of the world, by ascending id. tick: that was stepped last.
  void Follow(std::span<const ShownBody> bodies, std::uint32_t tick);
  // The records of bodies[index] (of Follow) at kSnapshotErrorShares[quality]. Encodes them unless this capture has
  // been encoded already. Valid until the body is encoded again.
  const EncodedBody& Encode(std::size_t index, std::size_t quality, const CapturedBody& body,
                            const CapturedBlueprint& blueprint);
  // What Encode would return for the capture of this version; null when it would have to encode. version 0: null.
  [[nodiscard]] const EncodedBody* Find(std::size_t index, std::size_t quality, std::uint64_t version);

  // Predicts whether the body will be read after this tick: it will when as many ticks have passed since its last read
  // as lay between its last two. In a world that fits the clients' budgets that holds for every body that is due, and
  // in a crowd for those whose turn it is.
  [[nodiscard]] bool IsExpected(std::size_t index) const;
  // Encodes captures on all threads, at the qualities that are likely to be read. It changes no record: what was not
  // predicted is encoded by Encode.
  void EncodeAhead(std::span<const FreshCapture> captures);

  // The threads that EncodeAhead uses.
  [[nodiscard]] physics::Threads& Workers();

  // Records so far that missed their error target to fit into a packet, or did not fit at all.
  [[nodiscard]] std::uint64_t CoarsenedRecords() const;

 private:
  struct Encodings {
    std::uint32_t body = 0;
    std::array<Encoding, kQualities> qualities;
  };
  struct Job;
  class CrowdOfThread;
  struct Work;

  [[nodiscard]] bool IsExpected(const Encoding& encoding) const {
    return encoding.readBefore != 0 && m_tick - encoding.lastRead == encoding.lastRead - encoding.readBefore;
  }
  const EncodedBody& NoteRead(Encoding& encoding) const;

  std::vector<protocol::wire::Obstacle> m_obstacles;
  std::vector<Encodings> m_bodies;
  std::uint32_t m_tick = 0;
  std::unique_ptr<Work> m_work;
};

}  // namespace wobble::server
