// From the camera to the pixels: where things appear, what hides what, and what broken geometry does.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "client/terminal/camera.h"
#include "client/terminal/rasteriser.h"
#include "client/terminal/renderer.h"
#include "client/terminal/shadow.h"

namespace wobble::terminal {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

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
  for (const float value : {kNan, kInfinity, -kInfinity}) {
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

// A ball of 2 * lines * lines faces around `centre`.
struct Ball {
  std::vector<Vector3> rest, vertices;
  std::vector<std::array<std::uint16_t, 3>> faces;

  Ball(Vector3 centre, float radius, int lines = 16) {
    for (int i = 0; i <= lines; ++i) {
      for (int j = 0; j < lines; ++j) {
        const float polar = 3.14159265F * static_cast<float>(i) / static_cast<float>(lines);
        const float turn = 6.28318531F * static_cast<float>(j) / static_cast<float>(lines);
        rest.push_back(Vector3{std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)} *
                       radius);
        vertices.push_back(rest.back() + centre);
      }
    }
    const auto index = [lines](int i, int j) { return static_cast<std::uint16_t>(i * lines + j % lines); };
    for (int i = 0; i < lines; ++i) {
      for (int j = 0; j < lines; ++j) {
        faces.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
        faces.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
      }
    }
  }
  [[nodiscard]] DrawnBody Draw(Light colour) const { return {vertices, rest, faces, colour}; }
};

TEST(TerminalShadow, LiesWhereTheSunIsHidden) {
  const Ball ball({1, 2, 3}, 0.5F);
  ShadowMap shadows;
  shadows.Reset({0, 0, 0}, 10);
  shadows.Add(ball.vertices, ball.faces);
  const Vector3 below = Vector3{1, 2, 3} - kToSun * (3 / kToSun.z);  // on the ground
  EXPECT_EQ(shadows.FindShade(below), 1);
  EXPECT_EQ(shadows.FindShade(below + Vector3{0.3F, 0, 0}), 1);
  EXPECT_EQ(shadows.FindShade(below + Vector3{0.8F, 0, 0}), 0);
  EXPECT_EQ(shadows.FindShade({1, 2, 5}), 0) << "above the ball";
  EXPECT_EQ(shadows.FindShade({500, 0, 0}), 0) << "outside of the map";
  EXPECT_EQ(shadows.FindShade({kNan, 0, 0}), 0);
}

View MakeView(Vector3 own) {
  Camera camera(CameraMode::kFollow);
  camera.Update(0.03, own, std::span(&own, 1));
  return camera.MakeView();
}

int Brightness(Colour colour) { return colour.red + colour.green + colour.blue; }

TEST(TerminalRenderer, ShowsABallItsShadowAndTheSky) {
  const Vector3 centre{0, 0, 1.5F};
  const Ball ball(centre, 0.5F);
  const std::array<DrawnBody, 1> bodies{ball.Draw({1, 0, 0})};
  const View view = MakeView(centre);
  Renderer renderer;
  std::vector<Colour> pixels, without;
  renderer.Draw({{}, bodies, centre}, view, 80, 46, pixels);
  ASSERT_EQ(pixels.size(), 80U * 46U);
  renderer.Draw({{}, {}, centre}, view, 80, 46, without);
  const Viewport viewport(80, 46, view);
  const auto find = [&](Vector3 point) {
    const Vector3 seen = view.ToCamera(point);
    const int x = static_cast<int>(40 + seen.x * viewport.scale / seen.z);
    const int y = static_cast<int>(23 - seen.y * viewport.scale / seen.z);
    return static_cast<std::size_t>(y * 80 + x);
  };
  const Colour middle = pixels[find(centre)];
  EXPECT_GT(middle.red, 2 * middle.green) << "the ball is red";
  const Vector3 shadow = centre - kToSun * (centre.z / kToSun.z);
  EXPECT_LT(Brightness(pixels[find(shadow)]), Brightness(without[find(shadow)]) - 20);
  // A corner of the picture, far from both, is unchanged.
  EXPECT_EQ(pixels[79], without[79]);
  EXPECT_EQ(pixels.back(), without.back());
}

TEST(TerminalRenderer, ObstaclesAreWhereTheServerSays) {
  using protocol::wire::Obstacle, protocol::wire::ObstacleKind, protocol::wire::Vec3;
  const Vector3 own{0, 0, 1};
  const View view = MakeView(own);
  Renderer renderer;
  std::vector<Colour> sky, box, plane;
  const std::vector<Obstacle> away{{ObstacleKind::Box, Vec3(0, 0, -500), Vec3(1, 1, 1), 0}};
  const std::vector<Obstacle> near{{ObstacleKind::Box, Vec3(0, 0, -1), Vec3(3, 3, 1), 0}};
  const std::vector<Obstacle> floor{{ObstacleKind::Plane, Vec3(0, 0, 2), Vec3(0, 0, 0), 0}};
  renderer.Draw({away, {}, own}, view, 80, 46, sky);
  renderer.Draw({near, {}, own}, view, 80, 46, box);
  renderer.Draw({floor, {}, own}, view, 80, 46, plane);
  EXPECT_NE(box[30 * 80 + 40], sky[30 * 80 + 40]) << "the platform under the eye";
  EXPECT_EQ(box[30 * 80 + 40], plane[30 * 80 + 40]) << "both are level at z = 0";
  EXPECT_EQ(box[30 * 80 + 1], sky[30 * 80 + 1]) << "beside the platform";
  EXPECT_NE(plane[30 * 80 + 1], sky[30 * 80 + 1]) << "a plane has no end";
  EXPECT_EQ(plane[40], sky[40]);
}

TEST(TerminalRenderer, RoundObstaclesAndGroundAreWhereTheServerSays) {
  using protocol::wire::Obstacle, protocol::wire::ObstacleKind, protocol::wire::Vec3;
  View view = LookAlongY();
  view.eye = {0, -10, 0};
  Renderer renderer;
  std::vector<Colour> sky, round, capsule, ground;
  const std::vector<Obstacle> away{{ObstacleKind::Box, Vec3(0, 0, -500), Vec3(1, 1, 1), 0}};
  const std::vector<Obstacle> sphere{{ObstacleKind::Sphere, Vec3(1, 0, 0.5F), Vec3(), 2}};
  const std::vector<Obstacle> bar{{ObstacleKind::Capsule, Vec3(-3, 0, -1), Vec3(3, 0, 2), 0.5F}};
  // Level at -1 to the left of x = 0, rising to the right.
  const client::Ground slope{{-4, -4, 0}, 4, 3, 3, {-1, -1, 1, -1, -1, 1, -1, -1, 1}};
  renderer.Draw({away, {}, {}}, view, 120, 90, sky);
  renderer.Draw({sphere, {}, {}}, view, 120, 90, round);
  renderer.Draw({bar, {}, {}}, view, 120, 90, capsule);
  renderer.Draw({away, {}, {}, {&slope, 1}}, view, 120, 90, ground);
  const Viewport viewport(120, 90, view);
  int inSphere = 0, inBar = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const auto pixel = static_cast<std::size_t>(y * 120 + x);
      const Vector3 ray = Normalise(viewport.FindRay(view, x, y));
      const auto passes = [&](Vector3 from, Vector3 to) {  // least distance between the ray and the axis
        float nearest = 1e9F;
        for (float share = 0; share <= 1; share += 1.0F / 64) {
          const Vector3 point = from + (to - from) * share - view.eye;
          nearest = std::min(nearest, Length(point - ray * Dot(point, ray)));
        }
        return nearest;
      };
      const float ofSphere = passes({1, 0, 0.5F}, {1, 0, 0.5F}) - 2;
      const float ofBar = passes({-3, 0, -1}, {3, 0, 2}) - 0.5F;
      EXPECT_TRUE(std::abs(ofSphere) < 0.15F || (round[pixel] != sky[pixel]) == (ofSphere < 0)) << x << ", " << y;
      EXPECT_TRUE(std::abs(ofBar) < 0.15F || (capsule[pixel] != sky[pixel]) == (ofBar < 0)) << x << ", " << y;
      inSphere += ofSphere < 0 ? 1 : 0;
      inBar += ofBar < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(inSphere, 500);
  EXPECT_GT(inBar, 200);
  const auto find = [&](Vector3 point) {
    const Vector3 seen = view.ToCamera(point);
    const auto x = static_cast<std::size_t>(60 + seen.x * viewport.scale / seen.z);
    const auto y = static_cast<std::size_t>(45 - seen.y * viewport.scale / seen.z);
    return y * 120 + x;
  };
  EXPECT_NE(ground[find({-2, 0, -1})], sky[find({-2, 0, -1})]);
  EXPECT_NE(ground[find({3, 0, 0.4F})], sky[find({3, 0, 0.4F})]) << "half way up";
  EXPECT_EQ(ground[find({-2, 0, 0.5F})], sky[find({-2, 0, 0.5F})]) << "nothing above the level part";
  EXPECT_GT(Brightness(round[find({1, -2, 1.9F})]), Brightness(round[find({1, -2, -0.9F})])) << "lit from above";
}

// Two masses and a spring, seen from far and near, end on, and with a vertex that has no spring.
TEST(TerminalRenderer, SpringsAndMassesAreSeenWhereThereAreNoFaces) {
  const std::vector<Vector3> vertices{{-1, 0, 0}, {1, 0, 1}, {0, 0, -1}};
  const std::vector<std::array<std::uint16_t, 2>> edges{{0, 1}};
  const std::array<DrawnBody, 1> bodies{DrawnBody{vertices, vertices, {}, {0, 1, 0}, false, edges}};
  const std::vector<protocol::wire::Obstacle> away{{protocol::wire::ObstacleKind::Box, {0, 0, -500}, {1, 1, 1}, 0}};
  Renderer renderer;
  std::vector<Colour> pixels, sky;
  for (const float distance : {4.0F, 60.0F}) {
    View view = LookAlongY();
    view.eye = {0, -distance, 0};
    renderer.Draw({away, bodies, {}}, view, 120, 90, pixels);
    renderer.Draw({away, {}, {}}, view, 120, 90, sky);
    const Viewport viewport(120, 90, view);
    const auto isGreen = [&](Vector3 point) {
      const Vector3 seen = view.ToCamera(point);
      const auto x = static_cast<int>(60 + seen.x * viewport.scale / seen.z);
      const auto y = static_cast<int>(45 - seen.y * viewport.scale / seen.z);
      for (int i = 0; i < 9; ++i) {  // at the expected pixel or beside it
        const auto pixel = static_cast<std::size_t>((y + i / 3 - 1) * 120 + x + i % 3 - 1);
        if (pixels[pixel].green > sky[pixel].green + 15 && pixels[pixel].green > pixels[pixel].red + 15) return true;
      }
      return false;
    };
    for (const float share : {0.0F, 0.3F, 0.5F, 0.7F, 1.0F}) {
      EXPECT_TRUE(isGreen(vertices[0] + (vertices[1] - vertices[0]) * share)) << share << " at " << distance << " m";
    }
    EXPECT_TRUE(isGreen(vertices[2])) << "loose";
    EXPECT_FALSE(distance < 10 && isGreen({0, 0, -0.2F})) << "no spring there";
  }
  View along = LookAlongY();
  along.eye = {0, -3, 0};
  const std::vector<Vector3> endOn{{0, 0, 0}, {0, 2, 0}};
  const std::array<DrawnBody, 1> one{DrawnBody{endOn, endOn, {}, {0, 1, 0}, false, edges}};
  renderer.Draw({away, one, {}}, along, 120, 90, pixels);
  renderer.Draw({away, {}, {}}, along, 120, 90, sky);
  EXPECT_NE(pixels[45 * 120 + 60], sky[45 * 120 + 60]) << "the near mass";
  // A rod casts a shadow: a bar across the sunlight, above the floor.
  ShadowMap shadows;
  shadows.Reset({0, 0, 0}, 10);
  const std::array<Vector3, 4> strip{Vector3{-1, -0.1F, 2}, {-1, 0.1F, 2}, {1, 0.1F, 2}, {1, -0.1F, 2}};
  const std::array<std::array<std::uint16_t, 3>, 2> faces{{{0, 1, 2}, {0, 2, 3}}};
  shadows.Add(strip, faces);
  EXPECT_GT(shadows.FindShade(Vector3{0, 0, 2} - kToSun * (2 / kToSun.z)), 0.5F);
}

TEST(TerminalRenderer, OpenSurfacesAreLitFromBothSides) {
  const std::vector<Vector3> vertices{{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}};
  const std::vector<protocol::wire::Obstacle> away{{protocol::wire::ObstacleKind::Box, {0, 0, -500}, {1, 1, 1}, 0}};
  Renderer renderer;
  std::vector<Colour> pixels, sky;
  for (const float side : {-1.0F, 1.0F}) {
    View view = LookAlongY();
    view.eye = {0, side * 4, 0};
    view.forward = {0, -side, 0};
    view.right = {-side, 0, 0};
    renderer.Draw({away, {}, {}}, view, 60, 40, sky);
    for (const bool open : {false, true}) {
      const std::array<DrawnBody, 1> bodies{DrawnBody{vertices, vertices, faces, {1, 0, 0}, open}};
      renderer.Draw({away, bodies, {}}, view, 60, 40, pixels);
      const bool isSeen = pixels[22 * 60 + 30].red > sky[22 * 60 + 30].red + 40;
      EXPECT_EQ(isSeen, open || side < 0) << (open ? "open" : "closed") << " from y = " << side * 4;
    }
  }
}

TEST(TerminalRenderer, OutlivesBrokenBodiesAndSizes) {
  Ball ball({0, 0, 1}, 0.5F);
  ball.vertices[5].x = kNan;
  ball.vertices[40].z = kInfinity;
  ball.vertices[41] = {1e30F, 1e30F, -1e30F};
  const std::array<DrawnBody, 1> bodies{ball.Draw({1, 1, 1})};
  Renderer renderer;
  std::vector<Colour> pixels;
  for (const auto& [width, height] : {std::pair{1, 2}, {300, 2}, {24, 10}, {500, 300}}) {
    renderer.Draw({{}, bodies, {0, 0, 1}}, MakeView({0, 0, 1}), width, height, pixels);
    EXPECT_EQ(pixels.size(), static_cast<std::size_t>(width * height));
  }
}

TEST(TerminalCamera, LooksAtTheOwnBodyFromBehindAndAbove) {
  Camera camera(CameraMode::kFollow);
  const Vector3 own{3, -2, 1};
  camera.Update(0.03, own, std::span(&own, 1));
  const View view = camera.MakeView();
  const Vector3 seen = view.ToCamera(own);
  EXPECT_GT(seen.z, 3);
  EXPECT_LT(std::abs(seen.x), 1e-3F);
  EXPECT_LT(std::abs(seen.y), 1);
  EXPECT_GT(view.eye.z, own.z + 1);
  EXPECT_NEAR(Length(view.up), 1, 1e-5F);
  EXPECT_NEAR(Dot(view.up, view.forward), 0, 1e-5F);
  EXPECT_NEAR(Dot(view.right, view.up), 0, 1e-5F);
  EXPECT_GT(view.up.z, 0);
}

// Forward on the keyboard is away from the eye and right is right, for every direction of the camera.
TEST(TerminalCamera, KeysGoWhereTheyPointOnTheScreen) {
  Camera camera(CameraMode::kFollow);
  const Vector3 own{1, 1, 0.5F};
  for (int turn = 0; turn < 12; ++turn) {
    for (int i = 0; i < 100; ++i) camera.Update(0.03, own, std::span(&own, 1));
    const View view = camera.MakeView();
    const Vector3 before = view.ToCamera(own);
    const Direction forward = camera.ToWorld(0, 1), right = camera.ToWorld(1, 0);
    EXPECT_NEAR(std::hypot(forward.x, forward.y), 1, 1e-5F);
    EXPECT_GT(view.ToCamera(own + Vector3{forward.x, forward.y, 0}).z, before.z + 0.5F);
    EXPECT_NEAR(view.ToCamera(own + Vector3{forward.x, forward.y, 0}).x, before.x, 1e-3F);
    EXPECT_NEAR(view.ToCamera(own + Vector3{right.x, right.y, 0}).x, before.x + 1, 1e-3F);
    camera.Turn(0.6F);
  }
}

TEST(TerminalCamera, FollowsSmoothlyAndJumpsWithARespawn) {
  Camera camera(CameraMode::kFollow);
  Vector3 own{0, 0, 1};
  for (int i = 0; i < 60; ++i) camera.Update(0.03, own, std::span(&own, 1));
  own.x = 1;
  camera.Update(0.03, own, std::span(&own, 1));
  EXPECT_GT(camera.Focus().x, 0.05F);
  EXPECT_LT(camera.Focus().x, 0.6F);
  for (int i = 0; i < 60; ++i) camera.Update(0.03, own, std::span(&own, 1));
  EXPECT_NEAR(camera.Focus().x, 1, 0.01F);
  own = {-30, 40, 1};
  camera.Update(0.03, own, std::span(&own, 1));
  EXPECT_EQ(camera.Focus().x, -30);
}

TEST(TerminalCamera, DoesNotDependOnTheFrameRate) {
  Camera slow(CameraMode::kFollow), fast(CameraMode::kFollow);
  Vector3 own{0, 0, 1};
  for (Camera* camera : {&slow, &fast}) camera->Update(0.03, own, std::span(&own, 1));
  own.y = 2;
  for (int i = 0; i < 4; ++i) slow.Update(0.05, own, std::span(&own, 1));
  for (int i = 0; i < 20; ++i) fast.Update(0.01, own, std::span(&own, 1));
  EXPECT_NEAR(slow.Focus().y, fast.Focus().y, 0.01F);
}

TEST(TerminalCamera, TurnsTowardsWhereTheBodyGoes) {
  Camera camera(CameraMode::kFollow);
  Vector3 own{0, 0, 1};
  camera.Update(1.0 / 30, own, std::span(&own, 1));
  const Direction right = camera.ToWorld(1, 0);
  for (int i = 0; i < 300; ++i) {  // ten seconds of walking to the original right
    own = own + Vector3{right.x, right.y, 0} * (5.0F / 30);
    camera.Update(1.0 / 30, own, std::span(&own, 1));
  }
  const Direction forward = camera.ToWorld(0, 1);
  EXPECT_GT(forward.x * right.x + forward.y * right.y, 0.9F);
}

TEST(TerminalCamera, CirclesRoundAllBodies) {
  Camera camera(CameraMode::kCircle);
  const std::vector<Vector3> bodies{{-5, -5, 1}, {5, 5, 1}, {-5, 5, 1}, {5, -5, 1}};
  camera.Update(0.03, std::nullopt, bodies);
  const Vector3 before = camera.MakeView().eye;
  for (const Vector3& body : bodies) {
    const Vector3 seen = camera.MakeView().ToCamera(body);
    EXPECT_GT(seen.z, 1);
    EXPECT_LT(std::abs(seen.y / seen.z), View{}.tangent) << "in sight";
  }
  for (int i = 0; i < 100; ++i) camera.Update(0.03, std::nullopt, bodies);
  EXPECT_GT(Length(camera.MakeView().eye - before), 1);
  EXPECT_NEAR(camera.MakeView().eye.z, before.z, 1e-3F);
  camera.ChooseNextMode(false);
  for (int i = 0; i < 100; ++i) camera.Update(0.03, std::nullopt, bodies);
  const Vector3 standing = camera.MakeView().eye;
  camera.Update(1, std::nullopt, bodies);
  EXPECT_LT(Length(camera.MakeView().eye - standing), 0.01F);
  camera.ChooseNextMode(false);
  EXPECT_EQ(camera.Mode(), CameraMode::kCircle) << "nothing to follow";
  camera.ChooseNextMode(true);
  camera.ChooseNextMode(true);
  EXPECT_EQ(camera.Mode(), CameraMode::kFollow);
}

TEST(TerminalCamera, HasBodiesInSightThatAreFartherOutThanMost) {
  Camera camera(CameraMode::kCircle);
  std::vector<Vector3> bodies{{0, -9, 0.5F}, {0, 9, 0.5F}, {-9, 0, 0.5F}, {9, 0, 0.5F}};
  for (int i = 0; i < 8; ++i) bodies.push_back({0.5F * static_cast<float>(i % 4) - 0.75F, i < 4 ? -1.0F : 1.0F, 0.5F});
  for (int i = 0; i < 2000; ++i) {  // one full circle
    camera.Update(0.03, std::nullopt, bodies);
    for (const Vector3& body : bodies) {
      const Vector3 seen = camera.MakeView().ToCamera(body);
      ASSERT_LT(std::abs(seen.y / seen.z), View{}.tangent) << "picture " << i;
      ASSERT_LT(std::abs(seen.x / seen.z), View{}.tangent * 80 / 46) << "picture " << i;
    }
  }
}

TEST(TerminalCamera, ZoomAndTiltHaveLimits) {
  Camera camera(CameraMode::kFollow);
  const Vector3 own{0, 0, 1};
  const auto settle = [&] {
    for (int i = 0; i < 200; ++i) camera.Update(0.03, own, std::span(&own, 1));
    return camera.MakeView();
  };
  for (int i = 0; i < 100; ++i) camera.Zoom(1.5F);
  EXPECT_LT(Length(settle().eye - own), 40);
  for (int i = 0; i < 100; ++i) camera.Zoom(0.5F);
  EXPECT_GT(Length(settle().eye - own), 1);
  for (int i = 0; i < 100; ++i) camera.Tilt(0.3F);
  EXPECT_GT(settle().up.z, 0) << "never over the top";
  for (int i = 0; i < 100; ++i) camera.Tilt(-0.3F);
  EXPECT_LT(settle().forward.z, 0) << "never from below";
}

}  // namespace
}  // namespace wobble::terminal
