// Captured bodies to records, once for all clients, and only when one of them takes the body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/shape_codec.h"
#include "server/capture.h"

namespace wobble::server {

// A body's records, one for each patch, as bytes to be copied into packets.
using Records = std::span<const std::span<const std::uint8_t>>;

// Error target of a snapshot: RMS over a body's vertices, as a share of its size.
inline constexpr float kSnapshotErrorShare = 0.0025F;

class Encoder {
 public:
  // obstacles: of the welcome.
  explicit Encoder(std::vector<protocol::wire::Obstacle> obstacles = {}) : m_obstacles(std::move(obstacles)) {}
  // Forgets bodies that are not among these, the world's by ascending id.
  void Follow(std::span<const ShownBody> bodies);
  // Of the body at `index` of those. Encodes it unless this capture has been; valid until it is encoded again.
  Records Encode(std::size_t index, const CapturedBody& body, const CapturedBlueprint& blueprint);

  // Over all that was ever encoded; 0 when that is nothing.
  [[nodiscard]] std::uint64_t Vertices() const { return m_vertices; }
  [[nodiscard]] double BitsPerVertex() const;
  [[nodiscard]] double ErrorPercentRms() const;  // of the body's size
  [[nodiscard]] std::uint64_t CoarsenedRecords() const {
    return m_coarsened;
  }  // missed the target to fit a packet, or did not fit at all

 private:
  struct EncodedBody {
    std::uint32_t body = 0;
    std::uint64_t version = 0;        // of the capture; 0: none yet
    std::vector<std::uint8_t> bytes;  // of all records
    std::vector<std::span<const std::uint8_t>> records;
  };
  void EncodeBody(const CapturedBody& body, const CapturedBlueprint& blueprint, EncodedBody& encoded);

  std::vector<protocol::wire::Obstacle> m_obstacles;
  protocol::ShapeEncoder m_shapes;
  std::vector<EncodedBody> m_bodies;
  std::vector<std::size_t> m_ends;      // scratch: of each record in the bytes
  std::vector<std::uint8_t> m_payload;  // scratch
  std::uint64_t m_vertices = 0;
  std::uint64_t m_bits = 0;
  std::uint64_t m_coarsened = 0;
  double m_errorSquares = 0;  // of error over size, summed over vertices
};

}  // namespace wobble::server
