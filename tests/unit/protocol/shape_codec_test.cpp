// The shape codec: decoded vertices are within the stated error, which the encoder reports as it is.
//
// Errors are measured independently of the encoder, in the world and in doubles; its figures are compared with them.
#include "protocol/codec/shape_codec.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/damage.h"
#include "tests/unit/protocol/shape_clouds.h"

namespace wobble::protocol {
namespace {

using clouds::Cloud;
using clouds::Coded;
using clouds::Decode;
using clouds::Encode;
using clouds::Error;
using clouds::ExpectFinite;
using clouds::FindError;
using clouds::kKinds;
using clouds::MakeBasis;
using clouds::MakeCloud;
using clouds::MakeFloor;
using clouds::MakeModel;
using test::Bytes;

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

}  // namespace
}  // namespace wobble::protocol
