#include "client/own_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "client/clearance.h"

namespace wobble::client {
namespace {

using protocol::Vector3;

constexpr double kFrame = 1.0 / 60;
constexpr double kLag = 0.1;    // from an input to the tick that uses it
constexpr double kDelay = 0.1;  // at which records are shown
constexpr float kGravity = -9.81F;
const wire::Drive kDrive{25, 6, 6};
// So fast that a body never comes near its top speed: the acceleration is constant.
const wire::Drive kUnbounded{10, 1000, 6};

double Horizontal(Vector3 v) { return std::hypot(v.x, v.y); }

TEST(FindPush, IsFullFarFromTheWantedVelocityAndProportionalNearIt) {
  const Pressed right{.moveX = 1};
  EXPECT_FLOAT_EQ(FindPush(kDrive, right, {}).x, 25);
  EXPECT_FLOAT_EQ(FindPush(kDrive, right, {4.5F, 0, 0}).x, 25);  // the band is a quarter of 6 m/s
  EXPECT_FLOAT_EQ(FindPush(kDrive, right, {5.25F, 0, 3}).x, 12.5F);
  EXPECT_FLOAT_EQ(FindPush(kDrive, right, {6, 0, 0}).x, 0);
  EXPECT_LT(FindPush(kDrive, right, {7, 0, 0}).x, 0);
  EXPECT_EQ(Horizontal(FindPush(kDrive, {}, {6, 0, 0})), 0);  // not asked to move: left to friction
  const Vector3 turning = FindPush(kDrive, right, {0, 6, 2});
  EXPECT_NEAR(Horizontal(turning), 25, 1e-4);
  EXPECT_FLOAT_EQ(turning.x, -turning.y);
  EXPECT_EQ(turning.z, 0);
}

TEST(FollowInputs, UnderConstantAccelerationGivesTheClosedForm) {
  const std::array inputs{Pressed{.from = 1, .moveX = 1}};
  for (const double time : {0.004, 0.05, 0.2, 0.31}) {
    const Lead lead = FollowInputs(kUnbounded, inputs, 1, 1 + time, {2, 1, 0}, 0.5F, kGravity);
    EXPECT_NEAR(lead.way.x, 2 * time + 0.5 * 5 * time * time, 1e-4) << time;
    EXPECT_NEAR(lead.way.y, time - 0.5 * 0 * time, 0.02) << time;
    EXPECT_NEAR(lead.velocity.x, 2 + 5 * time, 1e-3) << time;
  }
  // An input of before the beginning holds, one of after the end does nothing.
  const std::array later{Pressed{.from = 0, .moveX = 1}, Pressed{.from = 9, .moveX = -1}};
  EXPECT_NEAR(FollowInputs(kUnbounded, later, 1, 1.2, {}, 1, kGravity).way.x, 0.2, 1e-4);
  EXPECT_EQ(FollowInputs(kUnbounded, {}, 1, 1.2, {}, 1, kGravity).way.x, 0);
  EXPECT_EQ(FollowInputs(kUnbounded, later, 1, 1, {3, 0, 0}, 1, kGravity).way.x, 0);
}

TEST(FollowInputs, AJumpIsAThrowFromItsMomentOn) {
  const std::array inputs{Pressed{.from = 1.05, .jumps = true}};
  const Lead lead = FollowInputs(kDrive, inputs, 1, 1.25, {}, 1, kGravity);
  EXPECT_NEAR(lead.way.z, 6 * 0.2 - 0.5 * 9.81 * 0.04, 1e-4);
  EXPECT_NEAR(lead.velocity.z, 6 - 9.81 * 0.2, 1e-4);
}

// A body of an own little server, which takes inputs kLag after they are given or refuses them; it is shown kDelay
// late.
class Stage {
 public:
  explicit Stage(double obeys) : m_obeys(obeys) { own.NoteLag(kLag); }

  Vector3 Step() {
    m_now += kFrame;
    own.NoteInput(kDrive, input, m_now, true);
    m_pressed.push_back({.from = m_now, .moveX = input.moveX, .moveY = input.moveY});
    Pressed used;
    for (const Pressed& each : m_pressed) {
      if (each.from + kLag <= m_now) used = each;
    }
    const Vector3 push = FindPush(kDrive, used, m_velocity) * static_cast<float>(m_obeys);
    m_velocity = m_velocity + push * static_cast<float>(kFrame);
    m_place = m_place + m_velocity * static_cast<float>(kFrame);
    m_shown.push_back({.time = m_now, .centroid = m_place, .velocity = m_velocity, .isBorne = true});
    const auto late = static_cast<std::size_t>(std::lround(kDelay / kFrame));
    base = m_shown[m_shown.size() > late ? m_shown.size() - 1 - late : 0];
    base.time = m_now - kDelay;
    base.isHeld = isHeld;
    if (isHeld) base.velocity = {};
    return own.Follow(kDrive, base, m_now, kGravity);
  }
  void MoveTo(Vector3 place) { m_place = place; }

  OwnBody own;
  OwnBody::Base base;
  Input input;
  bool isHeld = false;

 private:
  double m_obeys;  // share of the push
  double m_now = 10;
  Vector3 m_place, m_velocity;
  std::vector<Pressed> m_pressed;
  std::vector<OwnBody::Base> m_shown;
};

TEST(OwnBody, MovesWithTheSecondFrameAndAtFullSpeedIsWhereItsRecordsAre) {
  Stage stage(0.6);
  for (int i = 0; i < 30; ++i) EXPECT_EQ(Horizontal(stage.Step()), 0);
  stage.input.moveX = 1;
  stage.Step();
  EXPECT_GT(stage.Step().x, 0.005 * 0.5) << "half a per cent of the radius";
  std::vector<float> shown, leads;
  for (int i = 0; i < 240; ++i) {
    leads.push_back(stage.Step().x);
    shown.push_back(stage.base.centroid.x + leads.back());
  }
  EXPECT_GT(leads[10], 0.2F);
  EXPECT_LT(leads.back(), 0.02F);
  for (std::size_t i = 1; i < shown.size(); ++i) EXPECT_GE(shown[i], shown[i - 1]) << i;
}

TEST(OwnBody, ARefusedInputBlendsBackWithoutGoingBeyond) {
  Stage stage(0);
  for (int i = 0; i < 30; ++i) stage.Step();
  stage.input.moveX = 1;
  std::vector<float> leads;
  for (int i = 0; i < 120; ++i) leads.push_back(stage.Step().x);
  const auto most = std::max_element(leads.begin(), leads.end());
  EXPECT_GT(*most, 0.1F);
  EXPECT_LT(most - leads.begin(), 24) << "frames: until the refusal is seen, and no further";
  for (auto next = most + 1; next != leads.end(); ++next) EXPECT_LE(*next, *(next - 1) + 1e-3F);
  EXPECT_LT(leads.back(), 0.15F * *most);
  stage.input.moveX = 0;
  for (int i = 0; i < 120; ++i) leads.push_back(stage.Step().x);
  for (const float lead : leads) EXPECT_GE(lead, 0);
  EXPECT_EQ(leads.back(), 0);
}

TEST(OwnBody, ATeleportSnaps) {
  Stage stage(0.6);
  stage.input.moveX = 1;
  for (int i = 0; i < 12; ++i) stage.Step();
  EXPECT_GT(stage.Step().x, 0.2F);
  stage.MoveTo({100, 50, 3});
  std::vector<float> leads;
  for (int i = 0; i < 10; ++i) leads.push_back(stage.Step().x);
  EXPECT_EQ(*std::min_element(leads.begin(), leads.end()), 0);
}

TEST(OwnBody, SilenceStopsIt) {
  Stage stage(0.6);
  stage.input.moveX = 1;
  for (int i = 0; i < 12; ++i) stage.Step();
  const float lead = stage.Step().x;
  EXPECT_GT(lead, 0.2F);
  stage.isHeld = true;
  float last = lead;
  for (int i = 0; i < 150; ++i) {
    const float next = stage.Step().x;
    EXPECT_LE(next, last);
    last = next;
  }
  EXPECT_EQ(last, 0);
}

wire::Obstacle MakeBox(Vector3 centre, Vector3 half) {
  return {wire::ObstacleKind::Box, wire::Vec3(centre.x, centre.y, centre.z), wire::Vec3(half.x, half.y, half.z), 0};
}

TEST(ClearLead, EndsAtAWallAndRunsAlongIt) {
  const std::array walls{MakeBox({0, 0, -1}, {10, 10, 1}), MakeBox({2, 0, 1}, {0.2F, 5, 1})};
  const Surroundings around{.obstacles = walls, .grounds = {}, .bodies = {}, .own = 1, .size = 0.5F};
  const Vector3 met = ClearLead(around, {0, 0, 0.45F}, {1.6F, 0.3F, 0});
  EXPECT_NEAR(met.x, 1.3, 1e-3);
  EXPECT_NEAR(met.y, 0.3, 1e-3);
  EXPECT_NEAR(met.z, 0, 1e-3) << "the floor neither stops nor lifts it";
  EXPECT_NEAR(ClearLead(around, {1.4F, 0, 0.45F}, {0, 1, 0}).y, 1, 1e-6) << "pressed into the wall already";
  EXPECT_NEAR(ClearLead(around, {1.4F, 0, 0.45F}, {0.3F, 0, 0}).x, 0, 2e-3);
  EXPECT_NEAR(ClearLead(around, {1.4F, 0, 0.45F}, {-1, 0, 0}).x, -1, 1e-6);
  EXPECT_LE(ClearLead(around, {10.6F, 0, -1}, {-0.5F, 0, 0}).z, 0) << "who falls beside a floor is not led onto it";
}

TEST(ClearLead, EndsAtAnotherBody) {
  const auto ball = std::make_shared<Blueprint>();
  ball->size = 0.6F;
  std::vector<BodySample> bodies(2);
  bodies[0].body = 1, bodies[1].body = 2;
  bodies[0].blueprint = bodies[1].blueprint = ball;
  bodies[1].pose.centroid = {3, 0, 0.5F};
  const Surroundings around{.obstacles = {}, .grounds = {}, .bodies = bodies, .own = 1, .size = 0.4F};
  EXPECT_NEAR(ClearLead(around, {0, 0, 0.5F}, {2.5F, 0, 0}).x, 2.05, 1e-3);
  EXPECT_NEAR(ClearLead(around, {2.5F, 0, 0.5F}, {0.2F, 0, 0}).x, 0, 1e-3) << "pressed into it already";
  EXPECT_NEAR(ClearLead(around, {2.5F, 0, 0.5F}, {-1, 0, 0}).x, -1, 1e-6);
}

TEST(ClearLead, IsLiftedWhereTheGroundRises) {
  const float slope = std::sqrt(0.1F);
  const std::array hills{wire::Obstacle(wire::ObstacleKind::Plane, wire::Vec3(-slope, 0, std::sqrt(0.9F)), {}, 0)};
  const Surroundings around{.obstacles = hills, .grounds = {}, .bodies = {}, .own = 1, .size = 0.5F};
  EXPECT_NEAR(ClearLead(around, {0, 0, 0.5F}, {0.9F, 0, 0}).z, 0.3, 0.01);
  EXPECT_EQ(ClearLead(around, {0, 0, 0.5F}, {-0.9F, 0, 0}).z, 0);
  const std::vector<Ground> grounds{
      {.corner = {-1, -1, 0}, .cellSize = 2, .columns = 2, .rows = 2, .heights = {0, 1, 0, 1}}};
  const Surroundings field{.obstacles = {}, .grounds = grounds, .bodies = {}, .own = 1, .size = 0.5F};
  EXPECT_NEAR(ClearLead(field, {0, 0, 1}, {0.4F, 0, 0}).z, 0.2, 0.01);
}

}  // namespace
}  // namespace wobble::client
