// Captured bodies to records, once for all clients, and only when one of them takes the body.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/shape_codec.h"
#include "server/capture.h"

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

class Encoder {
 public:
  // obstacles: of the welcome.
  explicit Encoder(std::vector<protocol::wire::Obstacle> obstacles = {}) : m_obstacles(std::move(obstacles)) {}
  // Forgets bodies that are not among these, the world's by ascending id.
  void Follow(std::span<const ShownBody> bodies);
  // Of the body at `index` of those, at one of kSnapshotErrorShares. Encodes it unless this capture has been; valid
  // until it is encoded again.
  const EncodedBody& Encode(std::size_t index, std::size_t quality, const CapturedBody& body,
                            const CapturedBlueprint& blueprint);

  // What Encode would return of this capture; null when it would have to encode it first.
  [[nodiscard]] const EncodedBody* Find(std::size_t index, std::size_t quality, std::uint64_t version) const {
    const Encoding& encoding = m_bodies[index].qualities[quality];
    return version != 0 && encoding.version == version ? &encoding.body : nullptr;
  }

  // Missed the target to fit a packet, or did not fit at all.
  [[nodiscard]] std::uint64_t CoarsenedRecords() const { return m_coarsened; }

 private:
  struct Encoding {
    std::uint64_t version = 0;        // of the capture; 0: none yet
    std::vector<std::uint8_t> bytes;  // of all records
    std::vector<std::span<const std::uint8_t>> records;
    EncodedBody body;
  };
  struct Encodings {
    std::uint32_t body = 0;
    std::array<Encoding, kQualities> qualities;
  };
  void EncodeBody(float errorShare, const CapturedBody& body, const CapturedBlueprint& blueprint, Encoding& encoding);

  std::vector<protocol::wire::Obstacle> m_obstacles;
  protocol::ShapeEncoder m_shapes;
  std::vector<Encodings> m_bodies;
  std::vector<std::size_t> m_ends;      // scratch: of each record in the bytes
  std::vector<std::uint8_t> m_payload;  // scratch
  std::uint64_t m_coarsened = 0;
};

}  // namespace wobble::server
