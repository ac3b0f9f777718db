// The shape codec: what a decoder shows is where the body was, within the stated error; every payload that is cut,
// changed or made up is refused or decoded, never read or written past its ends.
//
// Errors are measured anew, in the world and in doubles, from what DecodeShape gave; the encoder's figures are compared
// with them and not trusted.
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

// Between where the vertices are and where a client shows them, metres in the world.
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

Coded Encode(const Cloud& cloud, float target, std::size_t maxBytes = kMaxRecordPayload) {
  Coded coded;
  coded.encoding = EncodeShape(cloud.pose, cloud.rest, cloud.vertices, target, maxBytes, coded.bytes);
  return coded;
}

// Decodes into the middle of a block whose other vertices must stay as they are.
DecodeResult Decode(std::span<const std::uint8_t> bytes, std::span<const Vector3> rest, Pose& pose,
                    std::vector<Vector3>& shape) {
  constexpr float kUntouched = 12345;
  constexpr std::size_t kGuard = 4;
  std::vector<Vector3> block(rest.size() + 2 * kGuard, {kUntouched, kUntouched, kUntouched});
  const DecodeResult result = DecodeShape(bytes, rest, pose, std::span(block).subspan(kGuard, rest.size()));
  for (std::size_t i = 0; i < kGuard; ++i) {
    for (const Vector3& guard : {block[i], block[block.size() - 1 - i]}) {
      EXPECT_TRUE(guard.x == kUntouched && guard.y == kUntouched && guard.z == kUntouched);
    }
  }
  shape.assign(block.begin() + kGuard, block.end() - kGuard);
  EXPECT_STRNE(Name(result), "unknown");
  return result;
}

void ExpectFinite(const Pose& pose, std::span<const Vector3> shape) {
  const Quaternion q = pose.rotation;
  EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-5);
  for (const Vector3& v : shape) EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
}

TEST(ShapeCodec, ErrorIsWithinItsBoundsInTheWorld) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const std::size_t count = seed % 3 == 0 ? 42 : seed % 3 == 1 ? 162 : 12;
    const float size = seed % 2 == 0 ? 1.0F : 0.4F;
    const Cloud cloud = MakeCloud(seed, count, size, 0.002F * static_cast<float>(seed));
    for (const float percent : {0.1F, 0.25F, 1.0F, 3.0F}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", target " << percent << " %");
      const float target = percent / 100 * size;
      const Coded coded = Encode(cloud, target);
      ASSERT_TRUE(coded.encoding.fits);
      ASSERT_LE(coded.bytes.size(), kMaxRecordPayload);
      Pose pose;
      std::vector<Vector3> shape;
      ASSERT_EQ(Decode(coded.bytes, cloud.rest, pose, shape), DecodeResult::kOk);
      const Error error = FindError(cloud.vertices, pose, shape);
      const double rounding = 1e-5 * size;
      EXPECT_LE(error.max, coded.encoding.step * std::sqrt(3.0) / 2 + rounding);
      EXPECT_LE(error.rms, target + rounding);
      EXPECT_NEAR(error.rms, coded.encoding.rmsError, rounding);
      EXPECT_NEAR(error.max, coded.encoding.maxError, rounding);
      EXPECT_GE(coded.encoding.step, target) << "finer than needed: bits wasted";
    }
  }
}

TEST(ShapeCodec, FarFromTheOriginOnlyTheFloatsOfTheWorldAreCoarser) {
  Cloud cloud = MakeCloud(5, 162, 1, 0.05F);
  const Vector3 away{8000, -8000, 5000};
  for (Vector3& vertex : cloud.vertices) vertex = vertex - cloud.pose.centroid + away;
  cloud.pose.centroid = away;
  const Coded coded = Encode(cloud, 0.0025F);
  Pose pose;
  std::vector<Vector3> shape;
  ASSERT_EQ(Decode(coded.bytes, cloud.rest, pose, shape), DecodeResult::kOk);
  // A float at 8,000 m has steps of 1/2048 m, and showing a vertex rounds to them once more.
  const Error error = FindError(cloud.vertices, pose, shape);
  EXPECT_LE(error.max, coded.encoding.step * std::sqrt(3.0) / 2 + std::sqrt(3.0) / 4096 + 1e-5);
}

TEST(ShapeCodec, DecoderHasTheVerticesThatTheEncoderMeasured) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Cloud cloud = MakeCloud(seed, 162, 1, 0.1F);
    const Coded coded = Encode(cloud, 0.0025F);
    Pose pose;
    std::vector<Vector3> shape;
    ASSERT_EQ(Decode(coded.bytes, cloud.rest, pose, shape), DecodeResult::kOk);
    const Pose seen = Dequantise(Quantise(cloud.pose));
    ASSERT_EQ(pose.rotation.w, seen.rotation.w);
    ASSERT_EQ(pose.rotation.x, seen.rotation.x);
    ASSERT_EQ(pose.rotation.y, seen.rotation.y);
    ASSERT_EQ(pose.rotation.z, seen.rotation.z);
    ASSERT_EQ(pose.centroid.x, seen.centroid.x);
    ASSERT_EQ(pose.centroid.y, seen.centroid.y);
    ASSERT_EQ(pose.centroid.z, seen.centroid.z);
    // The encoder's error figures, with its own operations: equal to the last bit only if every vertex is.
    double sum = 0;
    float max = 0;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const Vector3 error = shape[i] - Rotate(Conjugate(seen.rotation), cloud.vertices[i] - seen.centroid);
      sum += Dot(error, error);
      max = std::max(max, Dot(error, error));
    }
    EXPECT_EQ(coded.encoding.maxError, std::sqrt(max)) << "seed " << seed;
    EXPECT_EQ(coded.encoding.rmsError, static_cast<float>(std::sqrt(sum / static_cast<double>(shape.size()))));
  }
}

TEST(ShapeCodec, ABodyAtRestCostsThreeBitsAVertex) {
  Cloud cloud = MakeCloud(3, 162, 1, 0);
  cloud.pose = Dequantise(Quantise(cloud.pose));
  for (std::size_t i = 0; i < cloud.rest.size(); ++i) cloud.vertices[i] = Transform(cloud.pose, cloud.rest[i]);
  const Coded coded = Encode(cloud, 0.0025F);
  // 17 bytes of pose and step, one bit a coordinate, and a few while the Rice parameter comes down.
  EXPECT_LE(coded.bytes.size(), 17U + 162 * 3 / 8 + 3);
  EXPECT_LT(coded.encoding.maxError, 1e-5F);
}

TEST(ShapeCodec, GetsCoarserUntilItFits) {
  const Cloud cloud = MakeCloud(4, 162, 1, 0.2F);
  const Coded fine = Encode(cloud, 0.0005F);
  ASSERT_TRUE(fine.encoding.fits);
  float step = fine.encoding.step;
  std::size_t smallest = fine.bytes.size();
  for (std::size_t maxBytes = fine.bytes.size(); maxBytes > 0; maxBytes -= std::min<std::size_t>(maxBytes, 7)) {
    const Coded coded = Encode(cloud, 0.0005F, maxBytes);
    if (!coded.encoding.fits) {
      EXPECT_TRUE(coded.bytes.empty()) << "nothing may be written when nothing fits";
      continue;
    }
    EXPECT_LE(coded.bytes.size(), maxBytes);
    EXPECT_GE(coded.encoding.step, step);
    step = coded.encoding.step;
    smallest = coded.bytes.size();
    Pose pose;
    std::vector<Vector3> shape;
    ASSERT_EQ(Decode(coded.bytes, cloud.rest, pose, shape), DecodeResult::kOk);
    EXPECT_LE(FindError(cloud.vertices, pose, shape).max, step * std::sqrt(3.0) / 2 + 1e-5);
  }
  EXPECT_GT(step, 100 * fine.encoding.step);
  EXPECT_LT(smallest, fine.bytes.size() / 3);
  EXPECT_FALSE(Encode(cloud, 0.0005F, 17).encoding.fits);
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
  ASSERT_TRUE(EncodeShape(cloud.pose, cloud.rest, cloud.vertices, 0.0025F, alone.bytes.size(), bytes).fits);
  ASSERT_EQ(bytes.size(), alone.bytes.size() + 3);
  EXPECT_EQ(Bytes(bytes.begin() + 3, bytes.end()), alone.bytes);
  ASSERT_FALSE(EncodeShape(cloud.pose, cloud.rest, cloud.vertices, 0.0025F, 3, bytes).fits);
  EXPECT_EQ(bytes.size(), alone.bytes.size() + 3);
}

// Residuals that the Rice code cannot say in kEscape ones, and beyond what an escape can say.
TEST(ShapeCodec, FarFlungVerticesAreCodedAsFarAsTheyGo) {
  Cloud cloud = MakeCloud(9, 12, 1, 0);
  cloud.pose = {};
  cloud.vertices = cloud.rest;
  cloud.vertices[0].x += 4000;
  cloud.vertices[5].z -= 4000;
  const Coded coded = Encode(cloud, 0.0025F);
  Pose pose;
  std::vector<Vector3> shape;
  ASSERT_EQ(Decode(coded.bytes, cloud.rest, pose, shape), DecodeResult::kOk);
  EXPECT_LE(FindError(cloud.vertices, pose, shape).max, coded.encoding.step * std::sqrt(3.0) / 2 + 3e-4);

  cloud.vertices[0].x = 1e9F;
  const Coded clamped = Encode(cloud, 0.0025F, 400);
  ASSERT_TRUE(clamped.encoding.fits);
  EXPECT_EQ(Decode(clamped.bytes, cloud.rest, pose, shape), DecodeResult::kOk);
  ExpectFinite(pose, shape);
}

// The worked example of STANDARD.md: four vertices, step 1/8 m.
struct Golden {
  std::vector<Vector3> rest{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}};
  Pose pose{{1.5F, -2.25F, 3}, {0.8F, 0, 0.6F, 0}};
  // Departures in the body frame, in steps: small, of both signs, and one that needs the escape.
  std::array<std::array<int, 3>, 4> residuals{{{1, 0, -2}, {0, 0, 3}, {-1, 250, 0}, {4, -5, 0}}};
  Bytes bytes{0x00, 0x18, 0x00, 0x00, 0x70, 0xFF, 0x0F, 0x00, 0x03, 0x00, 0xFF, 0x3F, 0x26, 0xFB, 0xFF,
              0xEF, 0x41, 0x60, 0x20, 0xF5, 0xFF, 0xFF, 0x4F, 0x1F, 0x00, 0x00, 0x20, 0x12, 0x00};
};

// A change here is a change of the format: raise kProtocolVersion and mend STANDARD.md.
TEST(ShapeCodec, GoldenBytes) {
  EXPECT_EQ(kProtocolVersion, 2);
  const Golden golden;
  const Pose seen = Dequantise(Quantise(golden.pose));
  Cloud cloud{golden.rest, {}, golden.pose};
  for (std::size_t i = 0; i < golden.rest.size(); ++i) {
    const auto [x, y, z] = golden.residuals[i];
    const Vector3 departure = Vector3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)} * 0.125F;
    cloud.vertices.push_back(Transform(seen, golden.rest[i] + departure));
  }
  const Coded coded = Encode(cloud, 0.0625F);
  EXPECT_EQ(coded.bytes, golden.bytes) << testing::PrintToString(coded.bytes);
  EXPECT_EQ(coded.encoding.step, 0.125F);

  Pose pose;
  std::vector<Vector3> shape;
  ASSERT_EQ(Decode(golden.bytes, golden.rest, pose, shape), DecodeResult::kOk);
  EXPECT_EQ(pose.centroid.x, 1.5F);
  EXPECT_EQ(pose.centroid.y, -2.25F);
  EXPECT_EQ(pose.centroid.z, 3.0F);
  EXPECT_NEAR(pose.rotation.y, 0.6F, 3e-5);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    EXPECT_EQ(shape[i].x, golden.rest[i].x + 0.125F * static_cast<float>(golden.residuals[i][0]));
    EXPECT_EQ(shape[i].y, golden.rest[i].y + 0.125F * static_cast<float>(golden.residuals[i][1]));
    EXPECT_EQ(shape[i].z, golden.rest[i].z + 0.125F * static_cast<float>(golden.residuals[i][2]));
  }
}

// A longer record, by its hash: every part of the adaptation has a say in it. All inputs are exact in floats.
TEST(ShapeCodec, GoldenHashOfALongerRecord) {
  Cloud cloud;
  std::mt19937 random(99);
  for (int i = 0; i < 100; ++i) {
    const auto draw = [&] { return static_cast<float>(static_cast<int>(random() % 2048) - 1024) / 1024; };
    const float x = draw(), y = draw(), z = draw();
    const float stretch = i < 40 ? 1.0F : i < 60 ? 16.0F : 1.0625F;
    cloud.rest.push_back({x, y, z});
    cloud.vertices.push_back({x * stretch, y * stretch + 0.5F, z * stretch});
  }
  const Coded coded = Encode(cloud, 0.0078125F);
  EXPECT_EQ(HashBytes(coded.bytes), 4904576801932360871U) << coded.bytes.size() << " bytes";
}

// Decodes and, when that succeeds, checks that all can be shown.
DecodeResult DecodeAndCheck(std::span<const std::uint8_t> bytes, std::span<const Vector3> rest) {
  Pose pose;
  std::vector<Vector3> shape;
  const DecodeResult result = Decode(bytes, rest, pose, shape);
  if (result == DecodeResult::kOk) ExpectFinite(pose, shape);
  return result;
}

TEST(ShapeCodec, EveryTruncationIsRefused) {
  const Cloud cloud = MakeCloud(10, 42, 1, 0.2F);
  test::ForEachTruncation(Encode(cloud, 0.0025F).bytes, [&](std::span<const std::uint8_t> cut) {
    const DecodeResult result = DecodeAndCheck(cut, cloud.rest);
    EXPECT_TRUE(result == DecodeResult::kTruncated || result == DecodeResult::kBadResidual) << Name(result);
  });
}

TEST(ShapeCodec, EveryChangedByteIsSafe) {
  const Cloud cloud = MakeCloud(11, 42, 1, 0.2F);
  std::array<int, 6> counts{};
  test::ForEachChangedByte(Encode(cloud, 0.0025F).bytes, [&](std::span<const std::uint8_t> changed) {
    ++counts[static_cast<std::size_t>(DecodeAndCheck(changed, cloud.rest))];
  });
  EXPECT_GT(counts[static_cast<std::size_t>(DecodeResult::kOk)], 0);
  EXPECT_GT(counts[static_cast<std::size_t>(DecodeResult::kTruncated)], 0);
  EXPECT_GT(counts[static_cast<std::size_t>(DecodeResult::kBadPose)], 0);
  EXPECT_GT(counts[static_cast<std::size_t>(DecodeResult::kBadStep)], 0);
  EXPECT_GT(counts[static_cast<std::size_t>(DecodeResult::kTrailingBytes)], 0);
}

TEST(ShapeCodec, RandomBytesAreSafe) {
  const Cloud cloud = MakeCloud(12, 12, 1, 0.2F);
  std::mt19937 random(13);
  int decoded = 0;
  for (int i = 0; i < 100000; ++i) {
    Bytes bytes(random() % 96);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    // Half of them ones in plenty: long quotients and escapes.
    if (i % 2 == 0) {
      for (std::size_t at = 17; at < bytes.size(); ++at) bytes[at] |= static_cast<std::uint8_t>(random() | random());
    }
    if (DecodeAndCheck(bytes, cloud.rest) == DecodeResult::kOk) ++decoded;
  }
  EXPECT_GT(decoded, 0) << "none got past the pose";
}

TEST(ShapeCodec, RefusalsHaveTheirReason) {
  const Golden golden;
  EXPECT_EQ(DecodeAndCheck({}, golden.rest), DecodeResult::kTruncated);
  EXPECT_EQ(DecodeAndCheck({}, {}), DecodeResult::kTruncated) << "even for a patch of no vertices";
  EXPECT_EQ(DecodeAndCheck(std::span(golden.bytes).first(16), {}), DecodeResult::kTruncated);
  Bytes longer = golden.bytes;
  longer.push_back(0);
  EXPECT_EQ(DecodeAndCheck(longer, golden.rest), DecodeResult::kTrailingBytes);
  Bytes filled = golden.bytes;
  filled.back() |= 0x80;
  EXPECT_EQ(DecodeAndCheck(filled, golden.rest), DecodeResult::kTrailingBytes) << "a one in the fill";
  Bytes step = golden.bytes;
  step[15] |= 0xE0, step[16] |= 0x0F;  // bits 125 to 131
  EXPECT_EQ(DecodeAndCheck(step, golden.rest), DecodeResult::kBadStep);
  Bytes turned = golden.bytes;
  for (std::size_t at = 10; at < 15; ++at) turned[at] = 0xFF;
  EXPECT_EQ(DecodeAndCheck(turned, golden.rest), DecodeResult::kBadPose);

  // A quotient of 23 at the largest Rice parameter is more than an escape can say.
  Bytes wide(golden.bytes.begin(), golden.bytes.begin() + 16);
  BitWriter writer(wide);
  writer.Write(golden.bytes[16] & 0xF, 4);
  for (int i = 0; i < 2; ++i) {  // escapes drive the parameter up
    writer.Write((1U << 24) - 1, 24);
    writer.Write((1U << 22) - 1, 22);
  }
  writer.Write((1U << 23) - 1, 24);
  writer.Write(0, 22);
  writer.Align();
  EXPECT_EQ(DecodeAndCheck(wide, golden.rest), DecodeResult::kBadResidual);
}

}  // namespace
}  // namespace wobble::protocol
