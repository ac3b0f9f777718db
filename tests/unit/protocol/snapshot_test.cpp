// Snapshot packets: built and read back byte for byte; truncated or changed packets are never read past their end.
#include "protocol/snapshot.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "tests/unit/damage.h"

namespace wobble::protocol {
namespace {

using test::Bytes;

Bytes MakePayload(std::size_t length, std::uint8_t first) {
  Bytes payload(length);
  std::iota(payload.begin(), payload.end(), first);
  return payload;
}

Bytes MakeRecord(const RecordHead& head, std::size_t length) {
  Bytes record;
  AppendRecord(head, MakePayload(length, head.patch), record);
  return record;
}

Bytes MakePacket() {
  PacketBuilder builder;
  EXPECT_TRUE(builder.Add(MakeRecord({1, 0, 0}, 20)));
  EXPECT_TRUE(builder.Add(MakeRecord({300, 254, 7}, 200)));
  EXPECT_TRUE(builder.Add(MakeRecord({0xFFFFFFFF, 3, 5, kGenerations - 1, 123456}, 1)));
  const auto packet = builder.Finish({.sequence = 77, .tick = 123456, .timeRatio = 0.5F, .inputTick = 123450});
  return {packet.begin(), packet.end()};
}

// Reads; whatever the result, the records returned lie inside the packet, one after the other. Touches every byte.
SnapshotResult ReadAndCheck(std::span<const std::uint8_t> packet) {
  SnapshotHead head;
  std::vector<Record> records;
  const SnapshotResult result = ReadSnapshot(packet, head, records);
  const std::uint8_t* end = packet.data() + std::min(packet.size(), kSnapshotHeadBytes);
  unsigned sum = 0;
  for (const Record& record : records) {
    EXPECT_NE(record.head.body, 0U);
    EXPECT_FALSE(record.payload.empty());
    EXPECT_GE(record.payload.data(), end + 3);
    end = record.payload.data() + record.payload.size();
    EXPECT_LE(end, packet.data() + packet.size());
    for (const std::uint8_t byte : record.payload) sum += byte;
  }
  if (result == SnapshotResult::kOk) {
    EXPECT_NE(head.sequence, 0U);
    EXPECT_TRUE(head.timeRatio >= 0.0F && head.timeRatio <= 1.0F);
    EXPECT_EQ(end, packet.data() + packet.size());
  }
  EXPECT_LT(sum, 256U * kMaxPacketBytes);
  EXPECT_STRNE(Name(result), "unknown");
  return result;
}

TEST(Snapshot, WhatIsBuiltIsRead) {
  const Bytes packet = MakePacket();
  SnapshotHead head;
  std::vector<Record> records;
  ASSERT_EQ(ReadSnapshot(packet, head, records), SnapshotResult::kOk);
  EXPECT_EQ(head.sequence, 77U);
  EXPECT_EQ(head.tick, 123456U);
  EXPECT_NEAR(head.timeRatio, 0.5F, 1.0F / 65535);
  EXPECT_EQ(head.inputTick, 123450U);
  ASSERT_EQ(records.size(), 3U);
  EXPECT_EQ(records[1].head.body, 300U);
  EXPECT_EQ(records[1].head.blueprint, 254);
  EXPECT_EQ(records[1].head.patch, 7);
  const Bytes payload(records[1].payload.begin(), records[1].payload.end());
  EXPECT_EQ(payload, MakePayload(200, 7));
  EXPECT_EQ(records[2].head.body, 0xFFFFFFFF);
  EXPECT_EQ(records[2].head.patch, 5);
  EXPECT_EQ(records[2].head.generation, kGenerations - 1);
  EXPECT_EQ(records[2].head.restTick, 123456U);
  EXPECT_EQ(records[1].head.restTick, 0U);
}

// A change here is a change of the format: raise kProtocolVersion and mend STANDARD.md.
TEST(Snapshot, GoldenBytes) {
  PacketBuilder builder;
  Bytes record;
  AppendRecord({.body = 300, .blueprint = 2, .patch = 1, .restTick = 200}, Bytes{0xAA, 0xBB}, record);
  ASSERT_TRUE(builder.Add(record));
  const auto packet = builder.Finish({.sequence = 0x01020304, .tick = 0x05060708, .inputTick = 0x090A0B0C});
  const Bytes expected{0x57, 0x06, 0x04, 0x03, 0x02, 0x01, 0x08, 0x07, 0x06, 0x05, 0xFF, 0xFF, 0x0C,
                       0x0B, 0x0A, 0x09, 0xAC, 0x02, 0x82, 0x01, 0xC8, 0x01, 0x02, 0xAA, 0xBB};
  EXPECT_EQ(Bytes(packet.begin(), packet.end()), expected);
  EXPECT_EQ(kProtocolVersion, 6);
}

TEST(Snapshot, ARestThatIsYetToComeIsRefused) {
  for (const std::uint32_t rest : {1U, 999U, 1000U, 1001U}) {
    PacketBuilder builder;
    ASSERT_TRUE(builder.Add(MakeRecord({1, 0, 0, 0, rest}, 5)));
    EXPECT_EQ(ReadAndCheck(builder.Finish({.sequence = 1, .tick = 1000})),
              rest <= 1000 ? SnapshotResult::kOk : SnapshotResult::kBadRecord);
  }
}

TEST(Snapshot, TheBuilderNeverExceedsAPacket) {
  std::mt19937 random(31);
  for (int round = 0; round < 200; ++round) {
    PacketBuilder builder;
    std::size_t expected = kSnapshotHeadBytes;
    for (;;) {
      const Bytes record = MakeRecord({static_cast<std::uint32_t>(random()) | 1, 0, 0}, 1 + random() % 400);
      const bool fits = expected + record.size() <= kMaxPacketBytes;
      ASSERT_EQ(builder.Add(record), fits);
      if (!fits) break;
      expected += record.size();
    }
    const auto packet = builder.Finish({.sequence = 1, .tick = 2});
    EXPECT_EQ(packet.size(), expected) << "a refused record leaves no trace";
    EXPECT_EQ(ReadAndCheck(packet), SnapshotResult::kOk);
  }
}

TEST(Snapshot, TheLargestRecordFitsAnEmptyPacket) {
  PacketBuilder builder;
  EXPECT_TRUE(builder.Empty());
  const Bytes record = MakeRecord({0xFFFFFFFF, 254, 7, 0, 0xFFFFFFFF}, kMaxRecordPayload);
  EXPECT_TRUE(builder.Add(record));
  EXPECT_FALSE(builder.Add(MakeRecord({1, 0, 0}, 1)));
  EXPECT_FALSE(builder.Empty());
  EXPECT_EQ(builder.Finish({.sequence = 1}).size(), kMaxPacketBytes);
  builder.Clear();
  EXPECT_TRUE(builder.Empty());
  EXPECT_TRUE(builder.Add(record));
}

TEST(Snapshot, TimeRatioIsKeptWithinItsRange) {
  for (const float ratio : {-1.0F, 0.0F, 0.25F, 1.0F, 7.0F}) {
    PacketBuilder builder;
    SnapshotHead head;
    std::vector<Record> records;
    ASSERT_EQ(ReadSnapshot(builder.Finish({.sequence = 1, .timeRatio = ratio}), head, records), SnapshotResult::kOk);
    EXPECT_NEAR(head.timeRatio, std::min(std::max(ratio, 0.0F), 1.0F), 1.0F / 65535);
  }
}

TEST(Snapshot, EveryTruncationIsRefusedOrEndsBetweenRecords) {
  const Bytes packet = MakePacket();
  int whole = 0;
  test::ForEachTruncation(packet, [&](std::span<const std::uint8_t> cut) {
    const SnapshotResult result = ReadAndCheck(cut);
    if (result == SnapshotResult::kOk) {
      ++whole;
    } else {
      EXPECT_EQ(result, SnapshotResult::kTruncated) << cut.size();
    }
  });
  EXPECT_EQ(whole, 3) << "the head alone, with one record, with two";
}

TEST(Snapshot, EveryChangedByteIsSafe) {
  int read = 0, refused = 0;
  test::ForEachChangedByte(MakePacket(), [&](std::span<const std::uint8_t> changed) {
    (ReadAndCheck(changed) == SnapshotResult::kOk ? read : refused) += 1;
  });
  EXPECT_GT(read, 0);
  EXPECT_GT(refused, 0);
}

TEST(Snapshot, RandomBytesAreSafe) {
  std::mt19937 random(32);
  for (int i = 0; i < 100000; ++i) {
    Bytes bytes(random() % 64);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (bytes.size() > 1 && i % 2 == 0) bytes[0] = 0x57, bytes[1] = kProtocolVersion;
    ReadAndCheck(bytes);
  }
}

SnapshotResult ReadChanged(std::size_t at, std::uint8_t value) {
  Bytes packet = MakePacket();
  packet[at] = value;
  return ReadAndCheck(packet);
}

TEST(Snapshot, RefusalsHaveTheirReason) {
  EXPECT_EQ(ReadChanged(0, 0x58), SnapshotResult::kBadHead) << "kind";
  EXPECT_EQ(ReadChanged(1, kProtocolVersion + 1), SnapshotResult::kBadHead) << "version";
  Bytes longWay = MakePacket();
  longWay.insert(longWay.begin() + 18, 2, 0);  // patch and generation, rest
  longWay[17] = 0x80;
  EXPECT_EQ(ReadAndCheck(longWay), SnapshotResult::kBadRecord) << "a patch and a rest that need not be said";
  EXPECT_EQ(ReadChanged(2, 0), SnapshotResult::kBadHead) << "sequence 0";
  EXPECT_EQ(ReadChanged(16, 0), SnapshotResult::kBadRecord) << "body 0";
  EXPECT_EQ(ReadChanged(18, 0), SnapshotResult::kBadRecord) << "no payload";
  Bytes large = MakePacket();
  large.resize(kMaxPacketBytes + 1);
  EXPECT_EQ(ReadAndCheck(large), SnapshotResult::kBadHead) << "larger than a packet may be";
  EXPECT_EQ(ReadAndCheck({}), SnapshotResult::kTruncated);
}

TEST(Snapshot, PatchesCoverABodyOnce) {
  for (const std::size_t count : {std::size_t{1}, std::size_t{512}, std::size_t{513}, kMaxBodyVertices}) {
    std::size_t sum = 0;
    for (std::size_t patch = 0; patch < 256; ++patch) {
      EXPECT_LE(PatchSize(count, patch), kMaxPatchVertices);
      sum += PatchSize(count, patch);
    }
    EXPECT_EQ(sum, count);
  }
  EXPECT_EQ(PatchSize(512, 1), 0U);
  EXPECT_EQ(PatchSize(513, 1), 1U);
}

}  // namespace
}  // namespace wobble::protocol
