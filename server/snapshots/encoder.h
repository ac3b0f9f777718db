// Captured bodies to records, once for all clients, and only when one of them takes the body.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "server/snapshots/capture.h"

namespace wobble::server {

// A body's records, one for each patch, as bytes to be copied into packets.
using Records = std::span<const std::span<const std::uint8_t>>;

// Error targets of a snapshot, finest first: RMS over a body's vertices, as shares of its size. The others are for what
// is far away, and for clients whose share of the wire would leave bodies out.
inline constexpr std::array<float, 3> kSnapshotErrorShares{0.0025F, 0.005F, 0.01F};
inline constexpr std::size_t kQualities = kSnapshotErrorShares.size();

struct EncodedBody {
  Records records;
  std::uint32_t vertices = 0;  // in them
  double errorSquares = 0;     // of error over size, summed over these
  double error = 0;            // RMS of that
};

// What the encoder keeps of one body at one quality.
struct Encoding {
  std::uint64_t version = 0;        // of the capture; 0: none yet
  std::vector<std::uint8_t> bytes;  // of all records
  std::vector<std::span<const std::uint8_t>> records;
  EncodedBody body;
  // Ticks after which it was read last, and before that; 0: not yet.
  std::uint32_t lastRead = 0;
  std::uint32_t readBefore = 0;
};

// A body that has been captured, and its place among those that Encoder::Follow was told of.
struct FreshCapture {
  std::size_t index = 0;
  const CapturedBody* body = nullptr;
  const CapturedBlueprint* blueprint = nullptr;
};

class Encoder {
 public:
  // obstacles: of the welcome.
  explicit Encoder(std::vector<protocol::wire::Obstacle> obstacles = {}, int threads = 1);
  ~Encoder();

  // Forgets bodies that are not among these, the world's by ascending id, after this tick.
  void Follow(std::span<const ShownBody> bodies, std::uint32_t tick);
  // Of the body at `index` of those, at one of kSnapshotErrorShares. Encodes it unless this capture has been; valid
  // until it is encoded again.
  const EncodedBody& Encode(std::size_t index, std::size_t quality, const CapturedBody& body,
                            const CapturedBlueprint& blueprint);
  // What Encode would return of this capture; null when it would have to encode it first.
  [[nodiscard]] const EncodedBody* Find(std::size_t index, std::size_t quality, std::uint64_t version);

  // Whether the body at `index` is likely to be asked for after this tick: it was read as long ago as it had been when
  // it was read then. Of a world that a client's share suffices for that is every body, and of a crowd those whose turn
  // it is.
  [[nodiscard]] bool IsExpected(std::size_t index) const;
  // Encodes these on all threads, at the qualities that are likely to be asked for. It changes nothing but who waits:
  // what was not expected is encoded when it is asked for.
  void EncodeAhead(std::span<const FreshCapture> captures);

  // Missed the target to fit a packet, or did not fit at all.
  [[nodiscard]] std::uint64_t CoarsenedRecords() const;

 private:
  struct Encodings {
    std::uint32_t body = 0;
    std::array<Encoding, kQualities> qualities;
  };
  struct Workers;

  [[nodiscard]] bool IsExpected(const Encoding& encoding) const {
    return encoding.readBefore != 0 && m_tick - encoding.lastRead == encoding.lastRead - encoding.readBefore;
  }
  const EncodedBody& NoteRead(Encoding& encoding) const;

  std::vector<protocol::wire::Obstacle> m_obstacles;
  std::vector<Encodings> m_bodies;
  std::uint32_t m_tick = 0;
  std::unique_ptr<Workers> m_workers;
};

}  // namespace wobble::server
