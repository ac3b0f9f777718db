// The bytes of shape payloads: golden ones; and every payload that is cut, changed or made up is refused or decoded
// without reading or writing past its ends.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "protocol/codec/basis_reader.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/codec/shape_layout.h"
#include "tests/unit/damage.h"
#include "tests/unit/protocol/shape_clouds.h"

namespace wobble::protocol {
namespace {

using clouds::Cloud;
using clouds::Coded;
using clouds::Decode;
using clouds::Encode;
using clouds::ExpectFinite;
using clouds::FindError;
using clouds::kKinds;
using clouds::MakeBasis;
using clouds::MakeCloud;
using clouds::MakeFloor;
using clouds::MakeModel;
using test::Bytes;

// Four vertices on a floor, in a basis of cosines.
struct Golden {
  Cloud cloud{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}}, {}, {{1.5F, -2.25F, 3}, {0.8F, 0, 0.6F, 0}}, 1.25F};
  std::shared_ptr<const Basis> basis;
  std::vector<wire::Obstacle> floor;
  Bytes bytes{0x79, 0xE9, 0x76, 0xAF, 0x89, 0xF6, 0x70, 0x89, 0xBF, 0xF3, 0x03, 0xE5, 0x27,
              0x65, 0xC7, 0x59, 0x22, 0x37, 0x55, 0x8C, 0xF1, 0x2A, 0xF1, 0xA7, 0x57, 0x9D};

  Golden() {
    BasisSource source;
    source.kind = BasisSource::Kind::kCosine;
    source.vertices = 4;
    source.grid = {2, 2, 1};
    source.levels.assign(12, kLevelZero - 16);
    source.gains.assign(12, 32);
    basis = ReadBasis(WriteBasis(source), 4);
    const std::array<Vector3, 4> departures{{{0.125F, 0, -0.25F}, {0, 0, 0.375F}, {-0.125F, 31.25F, 0}, {0.5F, 0, 0}}};
    for (std::size_t i = 0; i < 4; ++i) {
      cloud.vertices.push_back(Transform(cloud.pose, cloud.rest[i] + departures[i]));
    }
    floor.emplace_back(wire::ObstacleKind::Box, wire::Vec3(0, 0, 1), wire::Vec3(9, 9, 1), 0.0F);
  }
};

// A change here is a change of the format: raise kProtocolVersion and mend STANDARD.md.
TEST(ShapeCodec, GoldenBytes) {
  EXPECT_EQ(kProtocolVersion, 6);
  const Golden golden;
  const Coded coded = Encode(golden.cloud, 0.0625F, golden.basis.get(), kMaxRecordPayload, golden.floor);
  EXPECT_EQ(coded.bytes, golden.bytes) << testing::PrintToString(coded.bytes);

  Pose pose;
  std::vector<Vector3> shape;
  const PatchModel model = MakeModel(golden.cloud, golden.basis.get(), golden.floor);
  ASSERT_EQ(Decode(golden.bytes, model, pose, shape), DecodeResult::kOk);
  EXPECT_LE(FindError(golden.cloud.vertices, pose, shape).rms, 0.0626);
  for (Vector3& vertex : shape) vertex = Transform(pose, vertex);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(shape.data()), shape.size() * sizeof(Vector3));
  EXPECT_EQ(HashBytes(bytes), 2992979116953155486U) << "of the vertices in the world";
}

// Longer records, as a hash of their bytes and of the decoded vertices: every table takes part. All inputs are exact in
// floats.
TEST(ShapeCodec, GoldenHashOfLongerRecords) {
  Cloud cloud;
  std::mt19937 random(99);
  for (int i = 0; i < 96; ++i) {
    const auto draw = [&] { return static_cast<float>(static_cast<int>(random() % 2048) - 1024) / 1024; };
    const float x = draw(), y = draw(), z = draw();
    const float stretch = i < 40 ? 1.0F : i < 60 ? 16.0F : 1.0625F;
    cloud.rest.push_back({x, y, z});
    cloud.vertices.push_back({x * stretch, y * stretch + 0.5F, z * stretch});
  }
  Bytes all;
  std::vector<Vector3> vertices;
  for (const auto kind : kKinds) {
    const auto basis = MakeBasis(kind, 96, 0.25F);
    const Coded coded = Encode(cloud, 0.0078125F, basis.get(), kMaxRecordPayload, MakeFloor(cloud));
    Pose pose;
    std::vector<Vector3> shape;
    ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud, basis.get(), MakeFloor(cloud)), pose, shape), DecodeResult::kOk);
    all.insert(all.end(), coded.bytes.begin(), coded.bytes.end());
    for (const Vector3& point : shape) vertices.push_back(Transform(pose, point));
  }
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(vertices.data()), vertices.size() * sizeof(Vector3));
  EXPECT_EQ(HashBytes(all), 2254818072421686412U) << all.size() << " bytes";
  EXPECT_EQ(HashBytes(bytes), 10875711261876556303U);
}

// Decodes and, when that succeeds, checks that pose and vertices are finite.
DecodeResult DecodeAndCheck(std::span<const std::uint8_t> bytes, const PatchModel& model) {
  Pose pose;
  std::vector<Vector3> shape;
  const DecodeResult result = Decode(bytes, model, pose, shape);
  if (result == DecodeResult::kOk) ExpectFinite(pose, shape);
  return result;
}

// Up to four missing bytes are read as zeros and may give another valid record; more are noticed.
TEST(ShapeCodec, EveryTruncationIsSafeAndAllButTheLastAreRefused) {
  const Cloud cloud = MakeCloud(10, 42, 1, 0.2F);
  for (const auto kind : kKinds) {
    const auto basis = MakeBasis(kind, 42, 0.05F);
    const PatchModel model = MakeModel(cloud, basis.get());
    const Bytes whole = Encode(cloud, 0.0025F, basis.get()).bytes;
    std::size_t decoded = 0;
    test::ForEachTruncation(whole, [&](std::span<const std::uint8_t> cut) {
      if (DecodeAndCheck(cut, model) == DecodeResult::kOk) ++decoded;
    });
    EXPECT_LE(decoded, 4U);
  }
}

TEST(ShapeCodec, EveryChangedByteIsSafe) {
  const Cloud cloud = MakeCloud(11, 42, 1, 0.2F);
  std::array<int, 7> counts{};
  for (const auto kind : kKinds) {
    const auto basis = MakeBasis(kind, 42, 0.05F);
    const auto floor = MakeFloor(cloud);
    const PatchModel model = MakeModel(cloud, basis.get(), floor);
    const Coded coded = Encode(cloud, 0.01F, basis.get(), kMaxRecordPayload, floor);
    test::ForEachChangedByte(coded.bytes, [&](std::span<const std::uint8_t> changed) {
      ++counts[static_cast<std::size_t>(DecodeAndCheck(changed, model))];
    });
  }
  for (const DecodeResult result : {DecodeResult::kOk, DecodeResult::kTruncated, DecodeResult::kBadPose,
                                    DecodeResult::kBadMode, DecodeResult::kTrailingBytes}) {
    EXPECT_GT(counts[static_cast<std::size_t>(result)], 0) << Name(result);
  }
}

TEST(ShapeCodec, RandomBytesAreSafe) {
  const Cloud cloud = MakeCloud(12, 12, 1, 0.2F);
  const auto basis = MakeBasis(BasisSource::Kind::kFull, 12, 0.05F);
  std::mt19937 random(13);
  int decoded = 0;
  for (int i = 0; i < 100000; ++i) {
    Bytes bytes(random() % 48);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    // Half of the payloads have many ones, which are escapes.
    if (i % 2 == 0) {
      for (std::size_t at = 9; at < bytes.size(); ++at) bytes[at] |= static_cast<std::uint8_t>(random() | random());
    }
    if (DecodeAndCheck(bytes, MakeModel(cloud, basis.get())) == DecodeResult::kOk) ++decoded;
  }
  EXPECT_GT(decoded, 0) << "none got past the pose";
}

// The extremes that the checks of welcome and blueprint let through: UndefinedBehaviorSanitizer would see NaN become an
// integer, and here nothing is other than finite.
TEST(ShapeCodec, TheLargestObstaclesAndBodiesGiveFiniteShapes) {
  const Golden golden;
  const auto far = static_cast<float>(kWorldHalfExtent);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  int touching = 0, decoded = 0;
  for (int round = 0; round < 500; ++round) {
    Cloud cloud = golden.cloud;
    cloud.size = std::array{kMinBodySize, 1.25F, far}[round % 3];
    const float extent = std::array{0.001F, 1.0F, far}[random() % 3];
    for (Vector3& v : cloud.rest) v = Vector3{any(random), any(random), any(random)} * extent;
    std::vector<wire::Obstacle> obstacles;
    for (int i = 0; i < 12; ++i) {
      const Vector3 way{any(random), any(random), any(random)};
      const Vector3 normal = way * ((1 + any(random) * kUnitTolerance) / Length(way));
      const float offset = any(random) * (i % 2 == 0 ? far : 1.0F);
      obstacles.emplace_back(wire::ObstacleKind::Plane, wire::Vec3(normal.x, normal.y, normal.z),
                             wire::Vec3(offset, 0, 0), 0.0F);
    }
    obstacles.emplace_back(wire::ObstacleKind::Box, wire::Vec3(far, far, -far), wire::Vec3(far, far, far), 0.0F);
    const PatchModel model = MakeModel(cloud, golden.basis.get(), obstacles);
    const Pose pose{Vector3{any(random), any(random), any(random)} * far, {0.8F, 0, 0.6F, 0}};
    std::vector<Side> sides;
    FindSides(obstacles, pose, 4 * far, sides);
    ContactScratch contact;
    if (FindContact(model, sides, contact)) {
      ++touching;
      ExpectFinite(pose, contact.pressed);
    }
    Bytes payload = golden.bytes;
    if (round % 2 == 0) payload[random() % payload.size()] = static_cast<std::uint8_t>(random());
    decoded += DecodeAndCheck(payload, model) == DecodeResult::kOk ? 1 : 0;
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(decoded, 20);
}

TEST(ShapeCodec, RefusalsHaveTheirReason) {
  const Golden golden;
  const PatchModel model = MakeModel(golden.cloud, golden.basis.get(), golden.floor);
  EXPECT_EQ(DecodeAndCheck(golden.bytes, MakeModel(golden.cloud)), DecodeResult::kBadMode) << "the basis is not there";
  Bytes longer = golden.bytes;
  longer.insert(longer.end(), 5, 1);
  EXPECT_EQ(DecodeAndCheck(longer, model), DecodeResult::kTrailingBytes);
  const Bytes ones(64, 0xFF);
  EXPECT_NE(DecodeAndCheck(ones, model), DecodeResult::kOk);
}

}  // namespace
}  // namespace wobble::protocol
