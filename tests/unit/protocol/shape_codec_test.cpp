// The shape codec: decoded vertices are within the stated error, and every payload that is cut, changed or made up is
// refused or decoded without reading or writing past its ends.
//
// Errors are measured independently of the encoder, in the world and in doubles; its figures are compared with them.
#include "protocol/shape_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "protocol/limits.h"
#include "protocol/messages.h"
#include "protocol/pose.h"
#include "protocol/snapshot.h"
#include "tests/unit/damage.h"

namespace wobble::protocol {
namespace {

using test::Bytes;

struct Cloud {
  std::vector<Vector3> rest;      // body frame
  std::vector<Vector3> vertices;  // world
  Pose pose;
  float size = 1;
};

// A sphere of `count` points on a golden spiral, pressed in and rippled by about `deformation` of its radius.
Cloud MakeCloud(unsigned seed, std::size_t count, float size, float deformation) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  Cloud cloud;
  cloud.size = size;
  cloud.pose.centroid = {20 * unit(random), 20 * unit(random), 20 * unit(random)};
  Quaternion q{unit(random), unit(random), unit(random), unit(random)};
  const float length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  cloud.pose.rotation = {q.w / length, q.x / length, q.y / length, q.z / length};
  const Vector3 wave{4 * unit(random), 4 * unit(random), 4 * unit(random)};
  const float phase = 3 * unit(random);
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
    const float radius = std::sqrt(1 - z * z), angle = 2.3999632F * static_cast<float>(i);
    const Vector3 rest = Vector3{radius * std::cos(angle), radius * std::sin(angle), z} * size;
    const Vector3 noise = Vector3{unit(random), unit(random), unit(random)} * (0.3F * deformation * size);
    const float ripple = 1 + deformation * std::sin(Dot(wave, rest) / size + phase);
    cloud.rest.push_back(rest);
    cloud.vertices.push_back(Transform(cloud.pose, rest * ripple + noise));
  }
  return cloud;
}

struct Error {
  double rms = 0, max = 0;
};

// Between the vertices and where a client shows them, metres in the world.
Error FindError(std::span<const Vector3> vertices, const Pose& pose, std::span<const Vector3> shape) {
  Error error;
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3 seen = Transform(pose, shape[i]);
    const double x = double{seen.x} - vertices[i].x, y = double{seen.y} - vertices[i].y,
                 z = double{seen.z} - vertices[i].z;
    sum += x * x + y * y + z * z;
    error.max = std::max(error.max, std::sqrt(x * x + y * y + z * z));
  }
  error.rms = std::sqrt(sum / static_cast<double>(vertices.size()));
  return error;
}

struct Coded {
  ShapeEncoding encoding;
  Bytes bytes;
};

PatchModel MakeModel(const Cloud& cloud, const Basis* basis = nullptr, std::span<const wire::Obstacle> obstacles = {}) {
  return {
      .rest = cloud.rest, .size = cloud.size, .basis = basis, .obstacles = obstacles, .reach = FindReach(cloud.rest)};
}

Coded Encode(const Cloud& cloud, float target, const Basis* basis = nullptr, std::size_t maxBytes = kMaxRecordPayload,
             std::span<const wire::Obstacle> obstacles = {}) {
  Coded coded;
  ShapeEncoder encoder;
  coded.encoding =
      encoder.Encode(MakeModel(cloud, basis, obstacles), cloud.pose, cloud.vertices, target, maxBytes, coded.bytes);
  return coded;
}

// Decodes into the middle of a block whose other vertices must stay as they are.
DecodeResult Decode(std::span<const std::uint8_t> bytes, const PatchModel& model, Pose& pose,
                    std::vector<Vector3>& shape) {
  constexpr float kUntouched = 12345;
  constexpr std::size_t kGuard = 4;
  std::vector<Vector3> block(model.rest.size() + 2 * kGuard, {kUntouched, kUntouched, kUntouched});
  ShapeDecoder decoder;
  QuantisedPose read;
  const DecodeResult result = decoder.Decode(model, bytes, read, std::span(block).subspan(kGuard, model.rest.size()));
  for (std::size_t i = 0; i < kGuard; ++i) {
    for (const Vector3& guard : {block[i], block[block.size() - 1 - i]}) {
      EXPECT_TRUE(guard.x == kUntouched && guard.y == kUntouched && guard.z == kUntouched);
    }
  }
  pose = Dequantise(read);
  shape.assign(block.begin() + kGuard, block.end() - kGuard);
  EXPECT_STRNE(Name(result), "unknown");
  return result;
}

void ExpectFinite(const Pose& pose, std::span<const Vector3> shape) {
  const Quaternion q = pose.rotation;
  EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-5);
  for (const Vector3& v : shape) EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
}

// A basis of every kind for `vertices` = 6 · n, whose coefficients all spread by about `spread` metres.
std::shared_ptr<const Basis> MakeBasis(BasisSource::Kind kind, std::size_t vertices, float spread) {
  std::mt19937 random(21);
  BasisSource source;
  source.kind = kind;
  source.vertices = static_cast<std::uint16_t>(vertices);
  if (kind == BasisSource::Kind::kCosine) {
    source.grid = {3, static_cast<std::uint16_t>(vertices / 6), 2};
  } else {
    const std::size_t rows = kind == BasisSource::Kind::kFull ? 3 * vertices : vertices;
    for (std::size_t i = 0; i < 5 * rows; ++i) source.modes.push_back(static_cast<std::int8_t>(random() % 255) - 127);
    for (std::size_t i = 0; i < vertices; ++i) source.order.push_back(static_cast<std::uint16_t>(vertices - 1 - i));
  }
  source.levels.assign(3 * vertices,
                       static_cast<std::uint8_t>(kLevelZero + std::lround(8 * std::log2(static_cast<double>(spread)))));
  source.gains.assign(3 * vertices, 48);
  return ReadBasis(WriteBasis(source), vertices);
}

constexpr std::array<BasisSource::Kind, 3> kKinds = {BasisSource::Kind::kFull, BasisSource::Kind::kScalar,
                                                     BasisSource::Kind::kCosine};

// A floor that reaches a little into a body at this pose.
std::vector<wire::Obstacle> MakeFloor(const Cloud& cloud) {
  const Vector3 c = cloud.pose.centroid;
  return {wire::Obstacle(wire::ObstacleKind::Box, wire::Vec3(c.x, c.y, c.z - 0.8F * cloud.size - 1),
                         wire::Vec3(50, 50, 1), 0.0F)};
}

TEST(ShapeCodec, ErrorIsWithinTheTargetInTheWorld) {
  for (unsigned seed = 1; seed <= 120; ++seed) {
    const std::size_t count = seed % 3 == 0 ? 42 : seed % 3 == 1 ? 162 : 12;
    const float size = seed % 2 == 0 ? 1.0F : 0.4F;
    const Cloud cloud = MakeCloud(seed, count, size, 0.002F * static_cast<float>(seed));
    const auto basis = MakeBasis(kKinds[seed % 3], count, 0.05F * size);
    ASSERT_NE(basis, nullptr);
    const auto floor = MakeFloor(cloud);
    for (const float percent : {0.1F, 0.25F, 1.0F, 3.0F}) {
      for (const Basis* with : {static_cast<const Basis*>(nullptr), basis.get()}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", target " << percent << " %, basis "
                                        << (with != nullptr));
        const float target = percent / 100 * size;
        const Coded coded = Encode(cloud, target, with, kMaxRecordPayload, floor);
        ASSERT_TRUE(coded.encoding.fits);
        ASSERT_LE(coded.bytes.size(), kMaxRecordPayload);
        Pose pose;
        std::vector<Vector3> shape;
        ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud, with, floor), pose, shape), DecodeResult::kOk);
        const Error error = FindError(cloud.vertices, pose, shape);
        const double rounding = 1e-5 * size;
        EXPECT_LE(error.rms, target + rounding);
        if (0.001F * static_cast<float>(seed) * size > 3 * target) {
          EXPECT_GE(error.rms, 0.7 * target) << "finer than needed: bits wasted";
        }
        EXPECT_NEAR(error.rms, coded.encoding.rmsError, rounding);
        EXPECT_NEAR(error.max, coded.encoding.maxError, rounding);
      }
    }
  }
}

TEST(ShapeCodec, ABasisThatKnowsTheShapesSavesBits) {
  // A cloth with smooth bends, which take a few cosines.
  Cloud cloud;
  for (int i = 0; i < 162; ++i) {
    const auto x = static_cast<float>(i % 3), y = static_cast<float>(i / 3 % 27), z = static_cast<float>(i / 81);
    cloud.rest.push_back(Vector3{x - 1, y - 13, z - 0.5F} * 0.1F);
    cloud.vertices.push_back(cloud.rest.back() + Vector3{0.2F * std::cos(y / 9), 0, 0.1F * std::sin(y / 7)});
  }
  const auto basis = MakeBasis(BasisSource::Kind::kCosine, 162, 0.002F);
  EXPECT_LT(3 * Encode(cloud, 0.0025F, basis.get()).bytes.size(), Encode(cloud, 0.0025F).bytes.size());
}

TEST(ShapeCodec, ContactWithKnownGroundSavesBits) {
  Cloud cloud = MakeCloud(31, 162, 1, 0);
  cloud.pose.rotation = {};
  const auto floor = MakeFloor(cloud);
  const float ground = cloud.pose.centroid.z - 0.8F;
  for (std::size_t i = 0; i < cloud.rest.size(); ++i) {
    cloud.vertices[i] = cloud.pose.centroid + cloud.rest[i];
    cloud.vertices[i].z = std::max(cloud.vertices[i].z, ground);
  }
  const auto basis = MakeBasis(BasisSource::Kind::kCosine, 162, 0.02F);
  const std::size_t with = Encode(cloud, 0.0025F, basis.get(), kMaxRecordPayload, floor).bytes.size();
  EXPECT_LT(static_cast<double>(with), 0.9 * static_cast<double>(Encode(cloud, 0.0025F, basis.get()).bytes.size()));
}

TEST(ShapeCodec, FarFromTheOriginOnlyTheFloatsOfTheWorldAreCoarser) {
  Cloud cloud = MakeCloud(5, 162, 1, 0.05F);
  const Vector3 away{8000, -8000, 5000};
  for (Vector3& vertex : cloud.vertices) vertex = vertex - cloud.pose.centroid + away;
  cloud.pose.centroid = away;
  const Coded coded = Encode(cloud, 0.0025F);
  Pose pose;
  std::vector<Vector3> shape;
  ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud), pose, shape), DecodeResult::kOk);
  // A float at 8,000 m has steps of 1/2048 m, and Transform rounds to them once more.
  EXPECT_LE(FindError(cloud.vertices, pose, shape).rms, 0.0025F + std::sqrt(3.0) / 4096 + 1e-5);
}

TEST(ShapeCodec, DecoderHasTheVerticesThatTheEncoderMeasured) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Cloud cloud = MakeCloud(seed, 162, 1, 0.1F);
    const auto basis = MakeBasis(kKinds[seed % 3], 162, 0.05F);
    const Coded coded = Encode(cloud, 0.0025F, basis.get());
    Pose pose;
    std::vector<Vector3> shape;
    ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud, basis.get()), pose, shape), DecodeResult::kOk);
    // The encoder's error figures, computed with the same operations: equal to the last bit only if every vertex is.
    double sum = 0;
    float max = 0;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const Vector3 error = shape[i] - Rotate(Conjugate(pose.rotation), cloud.vertices[i] - pose.centroid);
      sum += double{Dot(error, error)};
      max = std::max(max, Dot(error, error));
    }
    EXPECT_EQ(coded.encoding.maxError, std::sqrt(max)) << "seed " << seed;
    EXPECT_EQ(coded.encoding.rmsError, static_cast<float>(std::sqrt(sum / static_cast<double>(shape.size()))));
  }
}

TEST(ShapeCodec, ThePoseAloneIsTheOneOfTheRecord) {
  const Cloud cloud = MakeCloud(7, 42, 0.4F, 0.1F);
  const Coded coded = Encode(cloud, 0.001F);
  Pose pose;
  std::vector<Vector3> shape;
  QuantisedPose alone;
  ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud), pose, shape), DecodeResult::kOk);
  ASSERT_EQ(DecodePose(coded.bytes, cloud.size, alone), DecodeResult::kOk);
  EXPECT_EQ(Dequantise(alone).centroid.x, pose.centroid.x);
  EXPECT_EQ(Dequantise(alone).rotation.w, pose.rotation.w);
}

TEST(ShapeCodec, ABodyAtRestCostsATenthOfABitAVertexBesideItsPose) {
  Cloud cloud = MakeCloud(3, 162, 1, 0);
  const auto basis = MakeBasis(BasisSource::Kind::kFull, 162, 1e-4F);
  const Coded coded = Encode(cloud, 0.0025F, basis.get());
  EXPECT_LE(coded.bytes.size(), 14U);
}

TEST(ShapeCodec, GetsCoarserUntilItFits) {
  const Cloud cloud = MakeCloud(4, 162, 1, 0.2F);
  const Coded fine = Encode(cloud, 0.0005F, nullptr, 2000);
  ASSERT_TRUE(fine.encoding.fits);
  float error = fine.encoding.rmsError;
  std::size_t smallest = fine.bytes.size();
  for (std::size_t maxBytes = fine.bytes.size(); maxBytes > 0; maxBytes -= std::min<std::size_t>(maxBytes, 7)) {
    const Coded coded = Encode(cloud, 0.0005F, nullptr, maxBytes);
    if (!coded.encoding.fits) {
      EXPECT_TRUE(coded.bytes.empty()) << "nothing may be written when nothing fits";
      continue;
    }
    EXPECT_LE(coded.bytes.size(), maxBytes);
    EXPECT_GE(coded.encoding.rmsError, 0.95F * error);
    error = coded.encoding.rmsError;
    smallest = coded.bytes.size();
    Pose pose;
    std::vector<Vector3> shape;
    ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud), pose, shape), DecodeResult::kOk);
    EXPECT_NEAR(FindError(cloud.vertices, pose, shape).rms, error, 1e-5);
  }
  EXPECT_LT(smallest, fine.bytes.size() / 3);
  EXPECT_FALSE(Encode(cloud, 0.0005F, nullptr, 3).encoding.fits);
}

TEST(ShapeCodec, AFullPatchFitsARecord) {
  const Cloud cloud = MakeCloud(6, kMaxPatchVertices, 1, 0.3F);
  const Coded coded = Encode(cloud, 0.0025F);
  EXPECT_TRUE(coded.encoding.fits);
  EXPECT_LE(coded.bytes.size(), kMaxRecordPayload);
}

TEST(ShapeCodec, AppendsAndLeavesWhatIsThere) {
  const Cloud cloud = MakeCloud(8, 42, 1, 0.1F);
  const Coded alone = Encode(cloud, 0.0025F);
  Bytes bytes{1, 2, 3};
  ShapeEncoder encoder;
  const PatchModel model = MakeModel(cloud);
  ASSERT_TRUE(encoder.Encode(model, cloud.pose, cloud.vertices, 0.0025F, alone.bytes.size(), bytes).fits);
  ASSERT_EQ(bytes.size(), alone.bytes.size() + 3);
  EXPECT_EQ(Bytes(bytes.begin() + 3, bytes.end()), alone.bytes);
  ASSERT_FALSE(encoder.Encode(model, cloud.pose, cloud.vertices, 0.0025F, 3, bytes).fits);
  EXPECT_EQ(bytes.size(), alone.bytes.size() + 3);
}

TEST(ShapeCodec, FarFlungVerticesAreCodedAsFarAsTheyGo) {
  Cloud cloud = MakeCloud(9, 12, 1, 0);
  cloud.pose = {};
  cloud.vertices = cloud.rest;
  cloud.vertices[0].x += 2000;
  cloud.vertices[5].z -= 2000;
  const Coded coded = Encode(cloud, 0.0025F);
  Pose pose;
  std::vector<Vector3> shape;
  ASSERT_EQ(Decode(coded.bytes, MakeModel(cloud), pose, shape), DecodeResult::kOk);
  EXPECT_LE(FindError(cloud.vertices, pose, shape).rms, 0.0025F + 3e-4);

  cloud.vertices[0].x = 1e9F;
  const Coded clamped = Encode(cloud, 0.0025F, nullptr, 400);
  if (!clamped.encoding.fits) return;
  EXPECT_EQ(Decode(clamped.bytes, MakeModel(cloud), pose, shape), DecodeResult::kOk);
  ExpectFinite(pose, shape);
}

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
  EXPECT_EQ(kProtocolVersion, 5);
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
