// The quantised pose: how far off it may be, what lies on its borders, and which bits are no pose.
#include "protocol/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/limits.h"

namespace wobble::protocol {
namespace {

Quaternion MakeUnitQuaternion(std::mt19937& random) {
  std::normal_distribution<float> normal;
  Quaternion q{normal(random), normal(random), normal(random), normal(random)};
  const float length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

Pose SendAndReceive(const Pose& pose) {
  std::vector<std::uint8_t> bytes;
  BitWriter writer(bytes);
  WritePose(writer, Quantise(pose));
  writer.Align();
  EXPECT_EQ(bytes.size(), 16U);  // 125 bits
  BitReader reader(bytes);
  QuantisedPose quantised;
  EXPECT_TRUE(ReadPose(reader, quantised));
  return Dequantise(quantised);
}

// The angle of the turn from one rotation to the other, radians; q and -q are one rotation. 2 asin |q1 - q2| / 2 and
// not acos of the product, which knows nothing below 1e-3 in floats.
double FindAngle(Quaternion p, Quaternion q) {
  const double minus = std::hypot(std::hypot(p.w - q.w, p.x - q.x), std::hypot(p.y - q.y, p.z - q.z));
  const double plus = std::hypot(std::hypot(p.w + q.w, p.x + q.x), std::hypot(p.y + q.y, p.z + q.z));
  return 4 * std::asin(std::min(minus, plus) / 2);
}

TEST(Pose, CentroidIsWithinHalfAGridStep) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> coordinate(-1000, 1000);
  for (int i = 0; i < 2000; ++i) {
    const Pose pose{{coordinate(random), coordinate(random), coordinate(random)}, {}};
    const Pose seen = SendAndReceive(pose);
    // Half the grid, and half a unit in the last place of a float of 1,000 m.
    const double bound = kCentroidStep / 2 + 1000 * 6e-8;
    EXPECT_NEAR(seen.centroid.x, pose.centroid.x, bound);
    EXPECT_NEAR(seen.centroid.y, pose.centroid.y, bound);
    EXPECT_NEAR(seen.centroid.z, pose.centroid.z, bound);
  }
}

TEST(Pose, RotationIsWithinTheGrid) {
  std::mt19937 random(12);
  // Each of three components is off by half a step of 1/(16383 sqrt 2); the fourth follows, at worst as far off as the
  // three together (when all four are equal): |dq| <= sqrt(3 + 9) / 2 steps, and the angle is twice that.
  const double bound = std::sqrt(12.0) / (16383 * std::sqrt(2.0)) * 1.01;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Quaternion q = MakeUnitQuaternion(random);
    const Quaternion seen = SendAndReceive({{}, q}).rotation;
    worst = std::max(worst, FindAngle(q, seen));
    const double length = std::sqrt(double{seen.w} * seen.w + double{seen.x} * seen.x + double{seen.y} * seen.y +
                                    double{seen.z} * seen.z);
    EXPECT_NEAR(length, 1, 3e-7);
  }
  EXPECT_LE(worst, bound);
  EXPECT_GE(worst, bound / 10) << "the bound says nothing";
}

TEST(Pose, AnUnturnedBodyAtTheOriginIsExact) {
  const Pose seen = SendAndReceive({});
  EXPECT_EQ(seen.centroid.x, 0.0F);
  EXPECT_EQ(seen.rotation.w, 1.0F);
  EXPECT_EQ(seen.rotation.x, 0.0F);
  EXPECT_EQ(seen.rotation.y, 0.0F);
  EXPECT_EQ(seen.rotation.z, 0.0F);
}

TEST(Pose, EachComponentMayBeTheLargest) {
  const std::array<Quaternion, 8> turns{{{1, 0, 0, 0},
                                         {0, 1, 0, 0},
                                         {0, 0, 1, 0},
                                         {0, 0, 0, 1},
                                         {-1, 0, 0, 0},
                                         {0, -1, 0, 0},
                                         {0, 0, -1, 0},
                                         {0, 0, 0, -1}}};
  for (std::size_t i = 0; i < turns.size(); ++i) {
    EXPECT_EQ(Quantise({{}, turns[i]}).largest, i % 4);
    EXPECT_EQ(FindAngle(SendAndReceive({{}, turns[i]}).rotation, turns[i]), 0) << i;
  }
  const Quaternion equal{-0.5F, 0.5F, -0.5F, 0.5F};
  EXPECT_LT(FindAngle(SendAndReceive({{}, equal}).rotation, equal), 2e-4);
}

TEST(Pose, BeyondTheWorldIsPutOnItsBorder) {
  const auto border = static_cast<float>(kWorldHalfExtent);
  const Pose seen = SendAndReceive({{1e9F, -1e9F, border}, {}});
  EXPECT_NEAR(seen.centroid.x, border, kCentroidStep);
  EXPECT_NEAR(seen.centroid.y, -border, kCentroidStep);
  EXPECT_NEAR(seen.centroid.z, border, kCentroidStep);
}

TEST(Pose, ARotationOfAnyLengthIsNormalised) {
  EXPECT_LT(FindAngle(SendAndReceive({{}, {8, 0, 6, 0}}).rotation, {0.8F, 0, 0.6F, 0}), 2e-4);
  EXPECT_EQ(SendAndReceive({{}, {0, 0, 0, 0}}).rotation.w, 1.0F);
}

bool IsRead(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  QuantisedPose pose;
  pose.a = a, pose.b = b, pose.c = c;
  std::vector<std::uint8_t> bytes;
  BitWriter writer(bytes);
  WritePose(writer, pose);
  writer.Align();
  BitReader reader(bytes);
  return ReadPose(reader, pose);
}

TEST(Pose, WhatIsNoRotationIsRefused) {
  EXPECT_TRUE(IsRead(16383, 16383, 16383));
  EXPECT_TRUE(IsRead(0, 16383, 16383));
  EXPECT_FALSE(IsRead(0, 0, 0)) << "squares add up to 3/2";
  EXPECT_FALSE(IsRead(32766, 16383, 0)) << "nothing left for the largest";
  EXPECT_FALSE(IsRead(32767, 16383, 16383)) << "beyond 1/sqrt 2";
}

TEST(Pose, ATruncatedPoseIsRefused) {
  for (std::size_t length = 0; length < 16; ++length) {
    const std::vector<std::uint8_t> bytes(length, 0x55);
    BitReader reader(bytes);
    QuantisedPose pose;
    EXPECT_FALSE(ReadPose(reader, pose)) << length;
    EXPECT_TRUE(reader.Overran()) << length;
  }
}

}  // namespace
}  // namespace wobble::protocol
