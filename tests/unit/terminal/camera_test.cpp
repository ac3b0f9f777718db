// The camera: its place relative to the bodies, its motion over time, and its limits.
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "client/terminal/camera.h"

namespace wobble::terminal {
namespace {

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
