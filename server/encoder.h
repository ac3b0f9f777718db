// Captured bodies to records, once for all clients.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "server/capture.h"

namespace wobble::server {

// A body's records, one for each patch, as bytes to be copied into packets.
struct EncodedBody {
  std::uint32_t body = 0;
  protocol::Vector3 centre;
  std::vector<std::span<const std::uint8_t>> records;
};

// Error target of a snapshot: RMS over a body's vertices, as a share of its size.
inline constexpr float kSnapshotErrorShare = 0.0025F;

class Encoder {
 public:
  // Encodes all bodies; what Bodies() returned before is then invalid.
  void Encode(std::span<const CapturedBody> bodies, std::span<const CapturedBlueprint> blueprints);
  [[nodiscard]] std::span<const EncodedBody> Bodies() const { return m_bodies; }

  // Over all that was ever encoded; 0 when that is nothing.
  [[nodiscard]] std::uint64_t Vertices() const { return m_vertices; }
  [[nodiscard]] double BitsPerVertex() const;
  [[nodiscard]] double ErrorPercentRms() const;  // of the body's size
  [[nodiscard]] std::uint64_t CoarsenedRecords() const {
    return m_coarsened;
  }  // missed the target to fit a packet, or did not fit at all

 private:
  struct Range {
    std::size_t begin, end;
  };
  void EncodeBody(const CapturedBody& body, const CapturedBlueprint& blueprint);

  std::vector<EncodedBody> m_bodies;
  std::vector<std::uint8_t> m_bytes;    // all records of a snapshot
  std::vector<Range> m_ranges;          // of each record in m_bytes
  std::vector<std::uint8_t> m_payload;  // scratch
  std::uint64_t m_vertices = 0;
  std::uint64_t m_bits = 0;
  std::uint64_t m_coarsened = 0;
  double m_errorSquares = 0;  // of error over size, summed over vertices
};

}  // namespace wobble::server
