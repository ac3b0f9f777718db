// The quantised pose: its error, its borders, and bits that are no pose.
#include "protocol/codec/pose.h"

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

// The grid of a ball of 1 m at a target of 0.25 %.
constexpr PoseGrid kGrid{11, 13};
constexpr double kStep = 1.0 / 2048, kTurn = 1.0 / 8192;

Pose SendAndReceive(const Pose& pose, PoseGrid grid = kGrid) {
  std::vector<std::uint8_t> bytes;
  RangeEncoder encoder(bytes);
  WritePose(encoder, Quantise(pose, grid));
  encoder.Finish();
  RangeDecoder decoder(bytes);
  QuantisedPose quantised;
  quantised.grid = grid;
  EXPECT_TRUE(ReadPose(decoder, quantised));
  EXPECT_FALSE(decoder.Overran());
  return Dequantise(quantised);
}

// The angle between two rotations, radians; q and -q are the same rotation. 2 asin |q1 - q2| / 2 rather than acos of
// the product, which is inaccurate below 1e-3 in floats.
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
    const double bound = kStep / 2 + 1000 * 6e-8;
    EXPECT_NEAR(seen.centroid.x, pose.centroid.x, bound);
    EXPECT_NEAR(seen.centroid.y, pose.centroid.y, bound);
    EXPECT_NEAR(seen.centroid.z, pose.centroid.z, bound);
  }
}

TEST(Pose, RotationIsWithinTheGrid) {
  std::mt19937 random(12);
  // Each of three components is off by half a step; the fourth follows, at worst as far off as the
  // three together (when all four are equal): |dq| <= sqrt(3 + 9) / 2 steps, and the angle is twice that.
  const double bound = std::sqrt(12.0) * kTurn * 1.01;
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
    EXPECT_EQ(Quantise({{}, turns[i]}, kGrid).largest, i % 4);
    EXPECT_EQ(FindAngle(SendAndReceive({{}, turns[i]}).rotation, turns[i]), 0) << i;
  }
  const Quaternion equal{-0.5F, 0.5F, -0.5F, 0.5F};
  EXPECT_LT(FindAngle(SendAndReceive({{}, equal}).rotation, equal), 4 * kTurn);
}

TEST(Pose, BeyondTheWorldIsPutOnItsBorder) {
  const auto border = static_cast<float>(kWorldHalfExtent);
  const Pose seen = SendAndReceive({{1e9F, -1e9F, border}, {}});
  EXPECT_NEAR(seen.centroid.x, border, kStep);
  EXPECT_NEAR(seen.centroid.y, -border, kStep);
  EXPECT_NEAR(seen.centroid.z, border, kStep);
}

TEST(Pose, ARotationOfAnyLengthIsNormalised) {
  EXPECT_LT(FindAngle(SendAndReceive({{}, {8, 0, 6, 0}}).rotation, {0.8F, 0, 0.6F, 0}), 4 * kTurn);
  EXPECT_EQ(SendAndReceive({{}, {0, 0, 0, 0}}).rotation.w, 1.0F);
}

bool IsRead(std::int32_t a, std::int32_t b, std::int32_t c) {
  QuantisedPose pose;
  pose.grid = kGrid;
  pose.a = a, pose.b = b, pose.c = c;
  std::vector<std::uint8_t> bytes;
  RangeEncoder encoder(bytes);
  WritePose(encoder, pose);
  encoder.Finish();
  RangeDecoder decoder(bytes);
  return ReadPose(decoder, pose);
}

TEST(Pose, WhatIsNoRotationIsRefused) {
  EXPECT_TRUE(IsRead(0, 0, 0));
  EXPECT_TRUE(IsRead(-5792, 0, 0));
  EXPECT_FALSE(IsRead(5792, 5792, 5792)) << "squares add up to 3/2";
  EXPECT_FALSE(IsRead(5792, 5000, 0)) << "too little left for the largest";
}

TEST(Pose, AnyGridKeepsWithinItsSteps) {
  std::mt19937 random(14);
  std::uniform_real_distribution<float> coordinate(-100, 100);
  for (const float size : {0.01F, 0.5F, 1.0F, 30.0F}) {
    for (unsigned grid = 0; grid <= kFinestGrid; ++grid) {
      const PoseGrid made = MakePoseGrid(grid, size);
      EXPECT_TRUE(made.turn >= kCoarsestTurn && made.turn <= kFinestTurn);
      const Pose pose{{coordinate(random), coordinate(random), coordinate(random)}, MakeUnitQuaternion(random)};
      const Pose seen = SendAndReceive(pose, made);
      EXPECT_NEAR(seen.centroid.y, pose.centroid.y, std::ldexp(0.5, -static_cast<int>(grid)) + 1e-5);
      EXPECT_LE(FindAngle(seen.rotation, pose.rotation), std::ldexp(3.6, -static_cast<int>(made.turn)));
    }
  }
}

TEST(Pose, ABodyInARoomCostsElevenBytes) {
  std::mt19937 random(15);
  std::uniform_real_distribution<float> coordinate(-4, 4);
  std::size_t bytes = 0;
  for (int i = 0; i < 500; ++i) {
    std::vector<std::uint8_t> one;
    RangeEncoder encoder(one);
    WritePose(
        encoder,
        Quantise({{coordinate(random), coordinate(random), coordinate(random)}, MakeUnitQuaternion(random)}, kGrid));
    encoder.Finish();
    bytes += one.size();
  }
  EXPECT_LE(bytes, 500U * 11 + 100);
}

}  // namespace
}  // namespace wobble::protocol
