// Shapes that are made of a few others are found again, within the error that is asked for.
#include "server/export/modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wobble::exporting {
namespace {

// Frames of `vertices` that are made of two shapes, and noise of this RMS over the coordinates.
Eigen::MatrixXf MakeFrames(Eigen::Index vertices, Eigen::Index frames, float noise) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  const auto draw = [&] { return normal(random); };
  const Eigen::MatrixXf shapes = Eigen::MatrixXf::NullaryExpr(3 * vertices, 2, draw);
  const Eigen::MatrixXf weights = Eigen::MatrixXf::NullaryExpr(2, frames, draw);
  return shapes * weights + noise * Eigen::MatrixXf::NullaryExpr(3 * vertices, frames, draw);
}

double FindWorst(const Eigen::MatrixXf& departures, const Modes& modes) {
  const Eigen::MatrixXf error = departures - modes.shapes * modes.weights;
  return std::sqrt(error.colwise().squaredNorm().maxCoeff() / (static_cast<double>(error.rows()) / 3));
}

TEST(Modes, AsFewAsAreNeeded) {
  for (const Eigen::Index frames : {20, 200}) {  // fewer and more than coordinates
    const Eigen::MatrixXf departures = MakeFrames(30, frames, 0.001F);
    const Modes modes = FindModes(departures, 0.01);
    EXPECT_EQ(modes.shapes.cols(), 2);
    EXPECT_LE(modes.error, 0.01);
    EXPECT_NEAR(modes.worstError, FindWorst(departures, modes), 1e-5);
    EXPECT_NEAR(modes.weights.cwiseAbs().rowwise().maxCoeff().minCoeff(), 1, 1e-6);
  }
}

TEST(Modes, OneFrameMayBeFartherOff) {
  Eigen::MatrixXf departures = MakeFrames(30, 200, 0);
  departures.col(77).array() += 0.05F;
  const Modes modes = FindModes(departures, 0.01);
  EXPECT_EQ(modes.shapes.cols(), 2);
  EXPECT_LE(modes.error, 0.01);
  EXPECT_GT(modes.worstError, 0.05);
  EXPECT_NEAR(modes.worstError, FindWorst(departures, modes), 1e-5);
}

TEST(Modes, WhatIsNearRestNeedsNone) {
  const Modes modes = FindModes(Eigen::MatrixXf::Constant(12, 5, 0.001F), 0.01);
  EXPECT_EQ(modes.shapes.cols(), 0);
  EXPECT_NEAR(modes.error, 0.001 * std::sqrt(3), 1e-7);
}

}  // namespace
}  // namespace wobble::exporting
