#include "protocol/snapshot.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "protocol/bits.h"

namespace wobble::protocol {
namespace {

constexpr std::uint8_t kKind = 0x57;  // 'W'
constexpr float kTimeRatioScale = 65535.0F;
constexpr unsigned kPatchBits = 3;
// Blueprints from this number on take one more byte. When patch, generation or restTick is not 0, the first two take a
// byte and the third a varint.
constexpr std::uint8_t kLongBlueprint = 127;
static_assert(kMaxBodyVertices <= kMaxPatchVertices << kPatchBits && kGenerations <= 1U << (8 - kPatchBits));

void PutLittleEndian(std::uint8_t* at, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) at[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint32_t GetLittleEndian(const std::uint8_t* at, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint32_t>(at[i]) << (8 * i);
  return value;
}

}  // namespace

void AppendRecord(const RecordHead& head, std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& out) {
  assert(head.body != 0 && head.patch < 1U << kPatchBits && head.generation < kGenerations);
  assert(!payload.empty() && payload.size() <= kMaxRecordPayload);
  BitWriter writer(out);
  writer.WriteVarint(head.body);
  const bool isPlain = head.patch == 0 && head.generation == 0 && head.restTick == 0;
  writer.Write(std::min<std::uint32_t>(head.blueprint, kLongBlueprint), 7);
  writer.Write(isPlain ? 0 : 1, 1);
  if (head.blueprint >= kLongBlueprint) writer.Write(head.blueprint, 8);
  if (!isPlain) {
    writer.Write(head.patch, kPatchBits);
    writer.Write(head.generation, 8 - kPatchBits);
    writer.WriteVarint(head.restTick);
  }
  writer.WriteVarint(static_cast<std::uint32_t>(payload.size()));
  out.insert(out.end(), payload.begin(), payload.end());
}

PacketBuilder::PacketBuilder() {
  m_bytes.reserve(kMaxPacketBytes);
  Clear();
}

void PacketBuilder::Clear() { m_bytes.assign(kSnapshotHeadBytes, 0); }

bool PacketBuilder::Add(std::span<const std::uint8_t> record) {
  if (m_bytes.size() + record.size() > kMaxPacketBytes) return false;
  m_bytes.insert(m_bytes.end(), record.begin(), record.end());
  return true;
}

std::span<const std::uint8_t> PacketBuilder::Finish(const SnapshotHead& head) {
  m_bytes[0] = kKind;
  m_bytes[1] = static_cast<std::uint8_t>(kProtocolVersion);
  PutLittleEndian(&m_bytes[2], head.sequence, 4);
  PutLittleEndian(&m_bytes[6], head.tick, 4);
  PutLittleEndian(&m_bytes[10],
                  static_cast<std::uint32_t>(std::lround(std::clamp(head.timeRatio, 0.0F, 1.0F) * kTimeRatioScale)), 2);
  PutLittleEndian(&m_bytes[12], head.inputTick, 4);
  return m_bytes;
}

SnapshotResult ReadSnapshot(std::span<const std::uint8_t> packet, SnapshotHead& head, std::vector<Record>& records) {
  records.clear();
  if (packet.size() < kSnapshotHeadBytes) return SnapshotResult::kTruncated;
  if (packet.size() > kMaxPacketBytes || packet[0] != kKind || packet[1] != kProtocolVersion) {
    return SnapshotResult::kBadHead;
  }
  head.sequence = GetLittleEndian(&packet[2], 4);
  head.tick = GetLittleEndian(&packet[6], 4);
  head.timeRatio = static_cast<float>(GetLittleEndian(&packet[10], 2)) / kTimeRatioScale;
  head.inputTick = GetLittleEndian(&packet[12], 4);
  if (head.sequence == 0) return SnapshotResult::kBadHead;

  std::span<const std::uint8_t> rest = packet.subspan(kSnapshotHeadBytes);
  while (!rest.empty()) {
    BitReader reader(rest);
    Record record;
    record.head.body = reader.ReadVarint();
    const std::uint32_t shortBlueprint = reader.Read(7);
    const bool isPlain = reader.Read(1) == 0;
    const bool isLong = shortBlueprint == kLongBlueprint;
    record.head.blueprint = static_cast<std::uint8_t>(isLong ? reader.Read(8) : shortBlueprint);
    if (!isPlain) {
      record.head.patch = static_cast<std::uint8_t>(reader.Read(kPatchBits));
      record.head.generation = static_cast<std::uint8_t>(reader.Read(8 - kPatchBits));
      record.head.restTick = reader.ReadVarint();
    }
    const bool isShortest =
        (!isLong || record.head.blueprint >= kLongBlueprint) &&
        (isPlain || record.head.patch != 0 || record.head.generation != 0 || record.head.restTick != 0);
    const std::uint32_t length = reader.ReadVarint();
    if (reader.Overran()) return SnapshotResult::kTruncated;
    const bool isAhead = record.head.restTick > head.tick;
    if (record.head.body == 0 || length == 0 || !isShortest || isAhead) return SnapshotResult::kBadRecord;
    if (length > rest.size() - reader.ByteOffset()) return SnapshotResult::kTruncated;
    record.payload = rest.subspan(reader.ByteOffset(), length);
    rest = rest.subspan(reader.ByteOffset() + length);
    records.push_back(record);
  }
  return SnapshotResult::kOk;
}

const char* Name(SnapshotResult result) {
  switch (result) {
    case SnapshotResult::kOk:
      return "ok";
    case SnapshotResult::kTruncated:
      return "truncated";
    case SnapshotResult::kBadHead:
      return "bad head";
    case SnapshotResult::kBadRecord:
      return "bad record";
  }
  return "unknown";
}

}  // namespace wobble::protocol
