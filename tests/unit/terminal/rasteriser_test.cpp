// Triangles to samples: where they appear, which hides which, and what broken triangles do.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "client/terminal/rasteriser.h"

namespace wobble::terminal {
namespace {

// Looks along y; x is right, z up.
View LookAlongY() { return View{}; }

// Counterclockwise for an eye on the -y side.
std::array<Corner, 3> MakeTriangle(float y, float size = 1, Vector3 middle = {}) {
  const Vector3 normal{0, -1, 0};
  return {Corner{middle + Vector3{-size, y, -size}, normal, {1, 0, 0}},
          Corner{middle + Vector3{size, y, -size}, normal, {0, 1, 0}},
          Corner{middle + Vector3{0, y, size}, normal, {0, 0, 1}}};
}

int CountCovered(const SampleGrid& grid) {
  int count = 0;
  for (const Sample& sample : grid.samples) count += sample.inverseDepth > 0 ? 1 : 0;
  return count;
}

SampleGrid MakeGrid(int width = 60, int height = 40) {
  SampleGrid grid;
  grid.Reset(width, height);
  return grid;
}

TEST(TerminalRasteriser, DrawsWhereTheProjectionSays) {
  SampleGrid grid = MakeGrid();
  const View view = LookAlongY();
  DrawTriangle(view, MakeTriangle(4), 7, grid);
  const Viewport viewport(grid.width, grid.height, view);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const Vector3 at = viewport.FindRay(view, x, y) * 4;  // on the plane of the triangle
      const float margin = std::min(at.z + 1, (1 - at.z) / 2 - std::abs(at.x));
      if (std::abs(margin) < 1e-3F) continue;
      ASSERT_EQ(grid.At(x, y).inverseDepth > 0, margin > 0) << x << ", " << y;
      if (margin < 0) continue;
      EXPECT_NEAR(grid.At(x, y).inverseDepth, 0.25F, 1e-5F);
      EXPECT_EQ(grid.At(x, y).material, 7U);
      // The weights of the corners are linear on the triangle.
      EXPECT_NEAR(grid.At(x, y).mark.z, (at.z + 1) / 2, 1e-4F);
    }
  }
}

TEST(TerminalRasteriser, InterpolatesInPerspective) {
  // A floor that recedes from the eye: the middle of the screen is not the middle of the floor.
  SampleGrid grid = MakeGrid(41, 41);
  const auto corner = [](float x, float y) { return Corner{{x, y, -1}, {0, 0, 1}, {0, y, 0}}; };
  DrawTriangle(LookAlongY(), {corner(-50, 1), corner(50, 1), corner(0, 101)}, 0, grid);
  int checked = 0;
  for (int y = 21; y < 41; ++y) {
    const Sample& sample = grid.At(20, y);
    if (sample.inverseDepth <= 0) continue;
    EXPECT_NEAR(sample.mark.y, 1 / sample.inverseDepth, 0.01F / sample.inverseDepth);
    ++checked;
  }
  EXPECT_GT(checked, 15);
}

TEST(TerminalRasteriser, TheNearerHidesTheFartherInEitherOrder) {
  for (const bool nearFirst : {true, false}) {
    SampleGrid grid = MakeGrid();
    const auto near = MakeTriangle(3), far = MakeTriangle(5, 3);
    DrawTriangle(LookAlongY(), nearFirst ? near : far, nearFirst ? 1 : 2, grid);
    DrawTriangle(LookAlongY(), nearFirst ? far : near, nearFirst ? 2 : 1, grid);
    EXPECT_EQ(grid.At(30, 20).material, 1U);
    EXPECT_EQ(grid.At(30, 36).material, 2U);
  }
}

TEST(TerminalRasteriser, TheBackOfATriangleIsNotDrawn) {
  SampleGrid grid = MakeGrid();
  auto turned = MakeTriangle(4);
  std::swap(turned[0], turned[1]);
  DrawTriangle(LookAlongY(), turned, 0, grid);
  EXPECT_EQ(CountCovered(grid), 0);
}

TEST(TerminalRasteriser, BehindTheEyeNothingIsDrawn) {
  SampleGrid grid = MakeGrid();
  DrawTriangle(LookAlongY(), MakeTriangle(-4), 0, grid);
  auto turned = MakeTriangle(-4);
  std::swap(turned[0], turned[1]);
  DrawTriangle(LookAlongY(), turned, 0, grid);
  DrawTriangle(LookAlongY(), MakeTriangle(kNearPlane / 2, 0.1F), 0, grid);
  EXPECT_EQ(CountCovered(grid), 0);
}

// A floor that extends behind the eye covers the same pixels as one that ends before the eye, where both are visible.
TEST(TerminalRasteriser, IsCutOffAtTheNearPlane) {
  const auto corner = [](float x, float y) { return Corner{{x, y, -1}, {0, 0, 1}, {}}; };
  for (const float back : {-0.5F, -5.0F, -4000.0F}) {
    SampleGrid grid = MakeGrid();
    DrawTriangle(LookAlongY(), {corner(-400, back), corner(400, back), corner(0, 500)}, 0, grid);
    for (int x = 0; x < grid.width; ++x) {
      EXPECT_GT(grid.At(x, grid.height - 1).inverseDepth, 0) << "at " << x << " with " << back;
      EXPECT_EQ(grid.At(x, 10).inverseDepth, 0) << "above the horizon";
    }
    const Viewport viewport(grid.width, grid.height, LookAlongY());
    const float slope = -viewport.FindRay(LookAlongY(), 30, 39).z;
    EXPECT_NEAR(grid.At(30, 39).inverseDepth, slope, 0.01F * slope);
  }
}

TEST(TerminalRasteriser, TwoCornersBehindLeaveATip) {
  SampleGrid grid = MakeGrid();
  const auto corner = [](float x, float y) { return Corner{{x, y, -1}, {0, 0, 1}, {}}; };
  DrawTriangle(LookAlongY(), {corner(-1, -3), corner(1, -3), corner(0, 9)}, 0, grid);
  EXPECT_GT(CountCovered(grid), 50);
}

TEST(TerminalRasteriser, BrokenTrianglesDrawNothing) {
  SampleGrid grid = MakeGrid();
  auto triangle = MakeTriangle(4);
  triangle[2].position = triangle[0].position;  // no area
  DrawTriangle(LookAlongY(), triangle, 0, grid);
  triangle[1].position = triangle[2].position;
  DrawTriangle(LookAlongY(), triangle, 0, grid);
  for (const float value : {NAN, INFINITY, -INFINITY}) {
    triangle = MakeTriangle(4);
    triangle[1].position.x = value;
    DrawTriangle(LookAlongY(), triangle, 0, grid);
  }
  EXPECT_EQ(CountCovered(grid), 0);
}

TEST(TerminalRasteriser, OutlivesAnyTriangle) {
  std::mt19937 random(12);
  SampleGrid grid = MakeGrid();
  std::uniform_real_distribution<float> power(-6, 30);
  for (int i = 0; i < 3000; ++i) {
    std::array<Corner, 3> corners;
    for (Corner& corner : corners) {
      const auto draw = [&] { return (random() % 2 == 0 ? 1.0F : -1.0F) * std::pow(10.0F, power(random)); };
      corner.position = {draw(), draw(), draw()};
    }
    DrawTriangle(LookAlongY(), corners, 0, grid);
  }
  for (const Sample& sample : grid.samples) ASSERT_TRUE(std::isfinite(sample.inverseDepth));
}

TEST(TerminalRasteriser, NormalsAreTheFacesMeanByArea) {
  // A corner of a box whose adjacent faces have 1, 2 and 4 m²: the mean leans to the largest.
  const std::vector<Vector3> vertices{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 4}, {9, 9, 9}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
  std::vector<Vector3> normals;
  ComputeNormals(vertices, faces, normals);
  ASSERT_EQ(normals.size(), 5U);
  const Vector3 expected = Normalise({4, 8, 2});
  EXPECT_NEAR(Length(normals[0] - expected), 0, 1e-6F);
  EXPECT_NEAR(normals[4].z, 1, 1e-6F) << "of no face";
  for (const Vector3& normal : normals) EXPECT_NEAR(Length(normal), 1, 1e-6F);
  ComputeNormals(vertices, std::vector<std::array<std::uint16_t, 3>>{{0, 0, 0}, {1, 2, 1}}, normals);
  for (const Vector3& normal : normals) EXPECT_EQ(normal.z, 1) << "degenerate faces only";
}

}  // namespace
}  // namespace wobble::terminal
