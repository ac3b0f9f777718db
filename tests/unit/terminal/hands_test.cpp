// The commands that the hand keys send, observed at the server's end of a virtual network.
#include "client/terminal/hands.h"

#include <gtest/gtest.h>

#include "protocol/transport/virtual_network.h"

namespace wobble::terminal {
namespace {

using client::BodySample;
using protocol::Vector3;

constexpr std::uint32_t kOwn = 1, kBall = 2, kSheet = 3;

// A server's end that welcomes a client and stores what it receives.
class Desk {
 public:
  Desk() : m_network({1}), m_server(m_network.MakeServer()), client(m_network.MakeClient(), {}, 0) {
    for (int i = 0; i < 60 && client.ReadState() != client::State::kPlaying; ++i) Step();
    EXPECT_EQ(client.ReadState(), client::State::kPlaying);
  }

  void Step() {
    m_now += 1.0 / 60;
    m_server->Poll(m_now, [this](const transport::Event& event) { Take(event); });
    m_server->Flush();
    client.Update(m_now);
  }

  // A message received since the last call: its type and, where it has them, body and number.
  struct Heard {
    std::vector<wire::ClientBody> kinds;
    std::uint32_t body = 0;
    Vector3 vector;
    std::uint16_t grip = 0;
  };
  Heard Listen() {
    m_heard = {};
    for (int i = 0; i < 4; ++i) Step();
    return m_heard;
  }

 private:
  void Take(const transport::Event& event) {
    if (event.kind != transport::Event::Kind::kMessage) return;
    const std::vector<std::uint8_t> bytes(event.bytes.begin(), event.bytes.end());
    const wire::ClientMessage* message = nullptr;
    ASSERT_EQ(protocol::ParseClientMessage(bytes, message), protocol::ParseResult::kOk);
    if (message->body_as_Hello() != nullptr) Welcome(event.connection);
    const auto read = [](const wire::Vec3& v) { return Vector3{v.x(), v.y(), v.z()}; };
    if (const auto* input = message->body_as_Input()) {
      m_heard.grip = 0;
      if (input->hand() == nullptr) return;
      m_heard.body = input->hand()->body();
      m_heard.grip = input->hand()->grip();
      m_heard.vector = read(input->hand()->target());
      return;
    }
    m_heard.kinds.push_back(message->body_type());
    if (const auto* push = message->body_as_Push())
      m_heard.body = push->body(), m_heard.vector = read(*push->direction());
    if (const auto* cut = message->body_as_Cut()) m_heard.body = cut->body(), m_heard.vector = read(*cut->to());
    if (const auto* tune = message->body_as_Tune()) m_heard.vector = read(*tune->value());
  }

  void Welcome(transport::ConnectionId connection) {
    protocol::WelcomeFields fields{1, kOwn, 0, 60, 30, "desk", 0, {}};
    fields.hands = protocol::kMayGrab | protocol::kMayPush | protocol::kMayCut;
    fields.reach = 2;
    for (const protocol::Message& message : {protocol::MakeWelcome(fields), protocol::MakeTuning({.may = 7})}) {
      ASSERT_EQ(m_server->Send(connection, transport::Channel::kControl, message), transport::SendResult::kQueued);
    }
  }

  transport::VirtualNetwork m_network;
  std::unique_ptr<transport::Transport> m_server;
  double m_now = 0;
  Heard m_heard;

 public:
  client::Client client;
};

BodySample MakeSample(std::uint32_t body, Vector3 centre, bool open) {
  auto blueprint = std::make_shared<client::Blueprint>();
  blueprint->rest = {{-0.2F, 0, 0}, {0.2F, 0, 0}};
  blueprint->faces = {{0, 1, 0}};
  blueprint->open = open;
  BodySample sample;
  sample.body = body;
  sample.blueprint = blueprint;
  sample.pose.centroid = centre;
  for (const Vector3& v : blueprint->rest) sample.vertices.push_back(v + centre);
  return sample;
}

class TerminalHands : public testing::Test {
 protected:
  TerminalHands() {
    camera.Update(1, Vector3{}, {});
    const Direction ahead = camera.ToWorld(0, 1);
    forward = {ahead.x, ahead.y, 0};
    samples = {MakeSample(kOwn, {}, false), MakeSample(kBall, forward * 1.4F, false),
               MakeSample(kSheet, forward * 1.9F, true)};
  }
  void Press(char32_t key) { hands.Take(key, camera, samples, desk.client); }

  Desk desk;
  Camera camera{CameraMode::kFollow};
  Vector3 forward;
  std::vector<BodySample> samples;
  Hands hands;
};

TEST_F(TerminalHands, GrabHoldsWhatIsAheadAndCarriesIt) {
  Press(U'g');
  EXPECT_TRUE(hands.HoldsSomething());
  Desk::Heard heard = desk.Listen();
  EXPECT_EQ(heard.body, kBall);
  EXPECT_NE(heard.grip, 0);
  EXPECT_GT(Dot(heard.vector, forward), 0.5F);
  EXPECT_GT(heard.vector.z, 0.3F);
  samples[0].pose.centroid = forward * 3;
  hands.Update(camera, samples, desk.client);
  EXPECT_GT(Dot(desk.Listen().vector, forward), 3.5F) << "it comes along";
  Press(U'g');
  EXPECT_FALSE(hands.HoldsSomething());
  EXPECT_EQ(desk.Listen().grip, 0);
}

TEST_F(TerminalHands, WhatIsGoneIsLetGo) {
  Press(U'g');
  samples.erase(samples.begin() + 1);
  hands.Update(camera, samples, desk.client);
  EXPECT_FALSE(hands.HoldsSomething());
}

TEST_F(TerminalHands, NothingInReachIsLeftAlone) {
  samples = {MakeSample(kOwn, {}, false), MakeSample(kBall, forward * 2.5F, false)};
  for (const char32_t key : {U'g', U'v', U't'}) Press(key);
  EXPECT_FALSE(hands.HoldsSomething());
  EXPECT_TRUE(desk.Listen().kinds.empty());
}

TEST_F(TerminalHands, PushGoesForwardAndCutTakesWhatCanBeCut) {
  Press(U'v');
  Desk::Heard heard = desk.Listen();
  ASSERT_EQ(heard.kinds, std::vector{wire::ClientBody::Push});
  EXPECT_EQ(heard.body, kBall);
  EXPECT_GT(Dot(heard.vector, forward), 0.9F);
  Press(U't');
  heard = desk.Listen();
  ASSERT_EQ(heard.kinds, std::vector{wire::ClientBody::Cut});
  EXPECT_EQ(heard.body, kSheet) << "the ball is nearer, but holds gas";
}

TEST_F(TerminalHands, DigitsTune) {
  Press(U'2');
  EXPECT_FLOAT_EQ(desk.Listen().vector.x, 1.25F);
  Press(U'3');
  EXPECT_FLOAT_EQ(desk.Listen().vector.x, 0.8F);
  Press(U'4');
  EXPECT_FLOAT_EQ(desk.Listen().vector.x, 1) << "no faster than it goes";
  Press(U'6');
  const Vector3 gravity = desk.Listen().vector;
  EXPECT_GT(gravity.x, 1);
  EXPECT_NEAR(Length(gravity), 9.81F, 1e-3F);
  Press(U'b');
  EXPECT_TRUE(desk.Listen().kinds.empty()) << "no key of ours";
}

TEST_F(TerminalHands, KeysThatTheServerHasNoUseForAreNotNamed) { EXPECT_EQ(DescribeHandKeys(desk.client).size(), 6U); }

}  // namespace
}  // namespace wobble::terminal
