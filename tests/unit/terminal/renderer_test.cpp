// From a world to pixels: bodies, shadows, obstacles and springs at the expected places, and what broken bodies do.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "client/terminal/camera.h"
#include "client/terminal/renderer.h"
#include "client/terminal/shadow.h"

namespace wobble::terminal {
namespace {

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
  [[nodiscard]] DrawnBody Draw(Light colour) const {
    return {.vertices = vertices, .rest = rest, .faces = faces, .colour = colour};
  }
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
  EXPECT_EQ(shadows.FindShade({NAN, 0, 0}), 0);
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
  View view;
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
  const std::array<DrawnBody, 1> bodies{
      DrawnBody{.vertices = vertices, .rest = vertices, .faces = {}, .colour = {0, 1, 0}, .edges = edges}};
  const std::vector<protocol::wire::Obstacle> away{{protocol::wire::ObstacleKind::Box, {0, 0, -500}, {1, 1, 1}, 0}};
  Renderer renderer;
  std::vector<Colour> pixels, sky;
  for (const float distance : {4.0F, 60.0F}) {
    View view;
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
  View along;
  along.eye = {0, -3, 0};
  const std::vector<Vector3> endOn{{0, 0, 0}, {0, 2, 0}};
  const std::array<DrawnBody, 1> one{
      DrawnBody{.vertices = endOn, .rest = endOn, .faces = {}, .colour = {0, 1, 0}, .edges = edges}};
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
    View view;
    view.eye = {0, side * 4, 0};
    view.forward = {0, -side, 0};
    view.right = {-side, 0, 0};
    renderer.Draw({away, {}, {}}, view, 60, 40, sky);
    for (const bool open : {false, true}) {
      const std::array<DrawnBody, 1> bodies{
          DrawnBody{.vertices = vertices, .rest = vertices, .faces = faces, .colour = {1, 0, 0}, .open = open}};
      renderer.Draw({away, bodies, {}}, view, 60, 40, pixels);
      const bool isSeen = pixels[22 * 60 + 30].red > sky[22 * 60 + 30].red + 40;
      EXPECT_EQ(isSeen, open || side < 0) << (open ? "open" : "closed") << " from y = " << side * 4;
    }
  }
}

TEST(TerminalRenderer, OutlivesBrokenBodiesAndSizes) {
  Ball ball({0, 0, 1}, 0.5F);
  ball.vertices[5].x = NAN;
  ball.vertices[40].z = INFINITY;
  ball.vertices[41] = {1e30F, 1e30F, -1e30F};
  const std::array<DrawnBody, 1> bodies{ball.Draw({1, 1, 1})};
  Renderer renderer;
  std::vector<Colour> pixels;
  for (const auto& [width, height] : {std::pair{1, 2}, {300, 2}, {24, 10}, {500, 300}}) {
    renderer.Draw({{}, bodies, {0, 0, 1}}, MakeView({0, 0, 1}), width, height, pixels);
    EXPECT_EQ(pixels.size(), static_cast<std::size_t>(width * height));
  }
}

}  // namespace
}  // namespace wobble::terminal
