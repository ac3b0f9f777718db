// Snapshot packets: a head, then whole records, each a patch of one body, byte-aligned and decodable alone.
//
// A record is encoded once for all clients; a packet only collects bytes. Clients differ in the head (sequence, input
// echo) and in the choice of records.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/limits.h"

namespace wobble::protocol {

struct SnapshotHead {
  std::uint32_t sequence = 0;   // of this packet to this client, from 1
  std::uint32_t tick = 0;       // of the world in its records
  float timeRatio = 1;          // world time per wall time over the last second, 0..1
  std::uint32_t inputTick = 0;  // stamp of the newest of this client's inputs that the world has used; 0: none yet
};
inline constexpr std::size_t kSnapshotHeadBytes = 16;

struct RecordHead {
  std::uint32_t body = 0;  // never 0
  std::uint8_t blueprint = 0;
  std::uint8_t patch = 0;       // its vertices begin at patch · kMaxPatchVertices
  std::uint8_t generation = 0;  // of the blueprint, below kGenerations
  // The tick since which the body has been at rest, at most the packet's; it stays at rest until a later record says
  // otherwise. 0: it moves.
  std::uint32_t restTick = 0;
};

struct Record {
  RecordHead head;
  std::span<const std::uint8_t> payload;  // a shape payload (shape_codec.h); a view of the packet
};

enum class SnapshotResult : std::uint8_t {
  kOk,
  kTruncated,  // ends inside the head or a record
  kBadHead,    // no snapshot of this version, or a field out of range
  kBadRecord,  // a record without a body or a payload, not in its shortest form, or at rest since a later tick
};
[[nodiscard]] const char* Name(SnapshotResult result);

// The largest payload of a record, bytes: a packet always holds at least one record.
inline constexpr std::size_t kMaxRecordPayload = kMaxPacketBytes - kSnapshotHeadBytes - 15;

// Appends a whole record: head, length of the payload, payload of 1..kMaxRecordPayload bytes.
void AppendRecord(const RecordHead& head, std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& out);

// Gathers records into one packet of at most kMaxPacketBytes.
class PacketBuilder {
 public:
  PacketBuilder();
  // Adds what AppendRecord made. False when it does not fit any more; the packet is then unchanged.
  [[nodiscard]] bool Add(std::span<const std::uint8_t> record);
  [[nodiscard]] bool Empty() const { return m_bytes.size() == kSnapshotHeadBytes; }
  // The packet with this head; valid until the next call. Clear begins the next packet.
  [[nodiscard]] std::span<const std::uint8_t> Finish(const SnapshotHead& head);
  void Clear();

 private:
  std::vector<std::uint8_t> m_bytes;
};

// Reads a packet's head and records in place: nothing is copied or decoded. Any bytes are safe. `records` gets all up
// to the first that is broken; the result then says so, and the caller drops the whole packet.
[[nodiscard]] SnapshotResult ReadSnapshot(std::span<const std::uint8_t> packet, SnapshotHead& head,
                                          std::vector<Record>& records);

// Patches of a body with `vertexCount` vertices.
[[nodiscard]] constexpr std::size_t PatchCount(std::size_t vertexCount) {
  return (vertexCount + kMaxPatchVertices - 1) / kMaxPatchVertices;
}
// Vertices in a patch of a body with `vertexCount` vertices; 0 when there is no such patch.
[[nodiscard]] constexpr std::size_t PatchSize(std::size_t vertexCount, std::size_t patch) {
  const std::size_t first = patch * kMaxPatchVertices;
  if (first >= vertexCount) return 0;
  return vertexCount - first < kMaxPatchVertices ? vertexCount - first : kMaxPatchVertices;
}

}  // namespace wobble::protocol
