// The client for C, from the shared library as it ships, against a scripted server.
#include "client/wobble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "protocol/version.h"
#include "tests/unit/c/scripted_world.h"

namespace wobble::c {
namespace {

TEST(Wobble, DescribesEveryResultInWordsOfItsOwn) {
  std::set<std::string> texts;
  for (int result = WOBBLE_INTERNAL; result <= WOBBLE_TOO_SMALL; ++result) texts.insert(wobble_describe(result));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(WOBBLE_TOO_SMALL - WOBBLE_INTERNAL + 1));
  EXPECT_STREQ(wobble_describe(4711), wobble_describe(-4711));
  EXPECT_EQ(texts.count(wobble_describe(4711)), 0U);
  EXPECT_STREQ(wobble_version(), kVersion);
}

TEST(Wobble, BeforeItPlaysThereIsNothingAndNobodyAnswersInTheEnd) {
  auto options = Make<wobble_connect_options>();
  options.address = "127.0.0.1:9";
  wobble_client* client = nullptr;
  ASSERT_EQ(wobble_connect(&options, 5, &client), WOBBLE_OK);
  const float vector[3] = {1, 0, 0};
  EXPECT_EQ(wobble_push(client, 1, 0, vector), WOBBLE_NOT_PLAYING);
  EXPECT_EQ(wobble_cut(client, 1, vector, vector, vector), WOBBLE_NOT_PLAYING);
  EXPECT_EQ(wobble_set_hand(client, nullptr), WOBBLE_NOT_PLAYING);
  EXPECT_EQ(wobble_tune(client, WOBBLE_TUNE_GRAVITY, vector), WOBBLE_NOT_PLAYING);
  EXPECT_EQ(wobble_order(client, "vote restart"), WOBBLE_NOT_PLAYING);
  auto frame = Make<wobble_frame>();
  EXPECT_EQ(wobble_sample(client, 5, &frame), WOBBLE_OK);
  EXPECT_EQ(frame.body_count + frame.vertex_count + frame.index_count, 0U);
  auto body = Make<wobble_body>();
  auto event = Make<wobble_event>();
  EXPECT_EQ(wobble_read_body(client, 0, &body), WOBBLE_BAD_INDEX);
  EXPECT_EQ(wobble_next_event(client, &event), WOBBLE_NO_EVENT);
  for (const double now : {4.9, std::nan(""), HUGE_VAL, 1e13}) EXPECT_EQ(wobble_update(client, now), WOBBLE_BAD_TIME);

  auto status = Make<wobble_status>();
  for (double now = 5; now < 20 && status.state != WOBBLE_ENDED; now += 0.1) {
    EXPECT_EQ(wobble_update(client, now), WOBBLE_OK);
    EXPECT_EQ(wobble_read_status(client, &status), WOBBLE_OK);
  }
  EXPECT_EQ(status.state, WOBBLE_ENDED);
  EXPECT_EQ(status.ended_unasked, 1);
  EXPECT_STREQ(status.reason, "no answer from the server");
  wobble_destroy(client);
}

TEST(Wobble, JoinsPlaysAndLeaves) {
  Joined joined;
  auto input = Make<wobble_input>();
  input.buttons = WOBBLE_JUMP | WOBBLE_STIFFEN;
  input.move_x = -1;
  EXPECT_EQ(wobble_set_input(joined.client, &input), WOBBLE_OK);
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING)) << joined.Status().reason;
  ASSERT_TRUE(joined.RunUntil([&] { return joined.world->newestInput.move_x() != 0; }));
  const wobble_status status = joined.Status();
  EXPECT_EQ(status.client_id, 9U);
  EXPECT_EQ(status.own_body, kOwnBody);
  EXPECT_EQ(status.hands, std::uint32_t{WOBBLE_MAY_GRAB | WOBBLE_MAY_BUILD});
  EXPECT_EQ(status.rank, WOBBLE_RANK_MODERATOR);
  EXPECT_EQ(status.reach, 2.5F);
  EXPECT_STREQ(status.scene, "pond");
  EXPECT_EQ(std::strlen(status.server_key), 64U);
  EXPECT_EQ(joined.world->newestInput.move_x(), -127);
  EXPECT_EQ(joined.world->newestInput.buttons(), 1 | 4);

  auto obstacle = Make<wobble_obstacle>();
  ASSERT_EQ(wobble_read_obstacle(joined.client, 0, &obstacle), WOBBLE_OK);
  EXPECT_EQ(obstacle.kind, WOBBLE_SPHERE);
  EXPECT_EQ(obstacle.a[2], 3);
  EXPECT_EQ(obstacle.radius, 4);
  EXPECT_EQ(wobble_read_obstacle(joined.client, 1, &obstacle), WOBBLE_BAD_INDEX);

  auto hand = Make<wobble_hand>();
  hand.body = kOtherBody;
  const float direction[3] = {0, 0, 1}, nothing[3] = {0, 0, 0}, broken[3] = {0, std::nanf(""), 0};
  EXPECT_EQ(wobble_set_hand(joined.client, &hand), WOBBLE_OK);
  EXPECT_EQ(wobble_push(joined.client, kOtherBody, 1, direction), WOBBLE_OK);
  EXPECT_EQ(wobble_cut(joined.client, kOtherBody, direction, nothing, direction), WOBBLE_OK);
  EXPECT_EQ(wobble_push(joined.client, kOtherBody, 1, nothing), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_push(joined.client, kOtherBody, 4096, direction), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_cut(joined.client, kOtherBody, direction, broken, direction), WOBBLE_BAD_VALUE);
  input.move_y = 1.01F;
  EXPECT_EQ(wobble_set_input(joined.client, &input), WOBBLE_BAD_VALUE);
  input.move_y = 0, input.buttons = 8;
  EXPECT_EQ(wobble_set_input(joined.client, &input), WOBBLE_BAD_FLAGS);
  EXPECT_TRUE(joined.RunUntil([&] { return joined.world->heldBody == kOtherBody && joined.world->commands == 2; }));
  EXPECT_EQ(wobble_set_hand(joined.client, nullptr), WOBBLE_OK);
  EXPECT_TRUE(joined.RunUntil([&] { return joined.world->heldBody == 0; }));
  EXPECT_EQ(joined.world->newestInput.move_x(), -127) << "wrong inputs change nothing";

  auto statistics = Make<wobble_statistics>();
  EXPECT_TRUE(joined.RunUntil(
      [&] { return wobble_read_statistics(joined.client, &statistics) == WOBBLE_OK && statistics.snapshots > 60; }));
  EXPECT_GT(statistics.bytes_received, 1000U);
  EXPECT_EQ(statistics.bad_messages, 0U);
  EXPECT_GT(statistics.join_seconds, 0);
  EXPECT_GT(statistics.server_time, 100.0 / 60);

  EXPECT_EQ(wobble_leave(joined.client, joined.now), WOBBLE_OK);
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_ENDED));
  EXPECT_EQ(joined.Status().ended_unasked, 0);
  EXPECT_EQ(wobble_leave(joined.client, joined.now), WOBBLE_OK);
  EXPECT_EQ(joined.world->badMessages, 0);
}

TEST(Wobble, SamplesIntoTheCallersArraysAndKeepsTwoSamplesItself) {
  Joined joined;
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING));
  auto frame = Make<wobble_frame>();
  ASSERT_TRUE(joined.RunUntil([&] {
    EXPECT_EQ(wobble_sample(joined.client, joined.now, &frame), WOBBLE_OK) << "nothing is to be written";
    return frame.body_count == 2;
  }));
  joined.Run(30);
  ASSERT_EQ(frame.vertex_count, 8U);
  ASSERT_EQ(frame.index_count, 24U);
  const std::uint32_t layout = frame.layout;

  std::vector<float> positions(24, 7), normals(24, 7);
  std::vector<std::uint32_t> indices(24, 7);
  frame.positions = positions.data(), frame.normals = normals.data(), frame.indices = indices.data();
  for (const auto& [vertices, count] : {std::pair{7U, 24U}, {8U, 23U}, {0U, 0U}}) {
    frame.vertex_capacity = vertices, frame.index_capacity = count;
    EXPECT_EQ(wobble_sample(joined.client, joined.now, &frame), WOBBLE_TOO_SMALL);
    EXPECT_EQ(frame.vertex_count, 8U);
    EXPECT_EQ(positions, std::vector<float>(24, 7));
    EXPECT_EQ(indices, std::vector<std::uint32_t>(24, 7));
  }
  frame.vertex_capacity = 8, frame.index_capacity = 24;
  ASSERT_EQ(wobble_sample(joined.client, joined.now, &frame), WOBBLE_OK);
  EXPECT_EQ(frame.layout, layout);

  auto own = Make<wobble_body>(), other = Make<wobble_body>();
  ASSERT_EQ(wobble_read_body(joined.client, 0, &own), WOBBLE_OK);
  ASSERT_EQ(wobble_read_body(joined.client, 1, &other), WOBBLE_OK);
  EXPECT_EQ(wobble_read_body(joined.client, 2, &other), WOBBLE_BAD_INDEX);
  EXPECT_EQ(own.body, kOwnBody);
  EXPECT_EQ(other.body, kOtherBody);
  EXPECT_STREQ(own.blueprint, "tetrahedron");
  EXPECT_NEAR(other.centroid[1], 5, 0.01);
  EXPECT_EQ(std::memcmp(own.positions, positions.data(), 12 * sizeof(float)), 0);
  EXPECT_EQ(std::memcmp(other.normals, normals.data() + 12, 12 * sizeof(float)), 0);
  EXPECT_NEAR(std::hypot(other.normals[0], other.normals[1], other.normals[2]), 1, 1e-5);
  ASSERT_EQ(other.first_vertex, 4U);
  ASSERT_EQ(other.first_index, 12U);
  for (std::uint32_t i = 0; i < 12; ++i) {
    EXPECT_EQ(indices[i], own.faces[i]);
    EXPECT_EQ(indices[12 + i], 4U + other.faces[i]);
  }

  // The next sample leaves this one as it is; the other body has not moved.
  const std::vector<float> before(own.positions, own.positions + 12);
  joined.Run(30);
  ASSERT_EQ(wobble_sample(joined.client, joined.now, nullptr), WOBBLE_OK);
  EXPECT_EQ(std::memcmp(own.positions, before.data(), 12 * sizeof(float)), 0);
  auto later = Make<wobble_body>();
  ASSERT_EQ(wobble_read_body(joined.client, 0, &later), WOBBLE_OK);
  EXPECT_GT(later.centroid[0], own.centroid[0]);
  EXPECT_EQ(later.changed, 1);
  ASSERT_EQ(wobble_read_body(joined.client, 1, &later), WOBBLE_OK);
  EXPECT_EQ(later.changed, 0);
  EXPECT_EQ(std::memcmp(later.normals, other.normals, 12 * sizeof(float)), 0);
}

TEST(Wobble, GivesEventsInOrderAndCountsThoseThatNobodyTook) {
  Joined joined;
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING));
  joined.world->Send(protocol::MakeEvent(wire::EventKind::Join, 101, 12, 5, "Grace"));
  joined.world->Send(protocol::MakeNotice("too far away"));
  auto event = Make<wobble_event>();
  const auto hasEvent = [&] { return wobble_next_event(joined.client, &event) == WOBBLE_OK; };
  ASSERT_TRUE(joined.RunUntil(hasEvent));
  EXPECT_EQ(event.kind, WOBBLE_JOIN);
  EXPECT_EQ(event.client_id, 12U);
  EXPECT_EQ(event.body, 5U);
  EXPECT_STREQ(event.text, "Grace");
  ASSERT_TRUE(joined.RunUntil(hasEvent));
  EXPECT_EQ(event.kind, WOBBLE_NOTICE);
  EXPECT_STREQ(event.text, "too far away");
  EXPECT_EQ(wobble_next_event(joined.client, &event), WOBBLE_NO_EVENT);

  joined.world->Send(protocol::MakeEvent(wire::EventKind::Said, 101, 12, 5, "hello"));
  joined.world->Send(protocol::MakeEvent(wire::EventKind::Emote, 101, 12, 5, "", wire::EmoteKind::Sad));
  joined.world->Send(protocol::MakeEvent(wire::EventKind::Rename, 101, 12, 5, "Hopper"));
  ASSERT_TRUE(joined.RunUntil(hasEvent));
  EXPECT_EQ(event.kind, WOBBLE_SAID);
  EXPECT_STREQ(event.text, "hello");
  ASSERT_TRUE(joined.RunUntil(hasEvent));
  EXPECT_EQ(event.kind, WOBBLE_EMOTED);
  EXPECT_EQ(event.emote, WOBBLE_SAD);
  ASSERT_TRUE(joined.RunUntil(hasEvent));
  EXPECT_EQ(event.kind, WOBBLE_RENAMED);
  EXPECT_STREQ(event.text, "Hopper");

  for (std::uint32_t i = 0; i < 1030; ++i) {
    joined.world->Send(protocol::MakeEvent(wire::EventKind::Leave, 102, i, 0, ""));
    if (i % 50 == 0) joined.Run(2);
  }
  auto statistics = Make<wobble_statistics>();
  EXPECT_TRUE(joined.RunUntil(
      [&] { return wobble_read_statistics(joined.client, &statistics) == WOBBLE_OK && statistics.events_lost == 6; }));
  ASSERT_EQ(wobble_next_event(joined.client, &event), WOBBLE_OK);
  EXPECT_EQ(event.client_id, 6U) << "the oldest are gone";

  joined.world->Send(protocol::MakeNextScene("hill"));
  EXPECT_TRUE(joined.RunUntil([&] {
    while (hasEvent() && event.kind != WOBBLE_NEW_WORLD) {
    }
    return event.kind == WOBBLE_NEW_WORLD;
  }));
  EXPECT_STREQ(event.text, "hill");
}

// Lets in who shows the password, and gives a ticket to come back with; the password is good only once.
class OnceJudge final : public transport::vestibule::Judge {
 public:
  using Credential = transport::vestibule::Credential;
  [[nodiscard]] bool WantsCredential() const override { return true; }
  [[nodiscard]] transport::NetAddress FindSource(Credential&, const transport::NetAddress& from) override {
    return from;
  }
  [[nodiscard]] transport::vestibule::Judgement Decide(const Credential& shown, const transport::NetAddress&) override {
    const std::vector<std::uint8_t> password{'o', 'p', 'e', 'n'}, ticket(40, 7);
    const bool isFirst = shown.kind == Credential::Kind::kPassword && shown.bytes == password && !m_isUsed;
    const bool isReturn = shown.kind == Credential::Kind::kToken && shown.bytes == ticket;
    m_isUsed = m_isUsed || isFirst;
    if (!isFirst && !isReturn) return {.refusal = transport::vestibule::Refusal::kBadCredential};
    return {.refusal = transport::vestibule::Refusal::kNone, .admission = {}, .ticket = ticket};
  }

 private:
  bool m_isUsed = false;
};

TEST(Wobble, TellsTheOthers) {
  Joined joined;
  EXPECT_EQ(wobble_say(joined.client, "hello"), WOBBLE_NOT_PLAYING);
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING));
  EXPECT_EQ(wobble_say(joined.client, "hello"), WOBBLE_OK);
  EXPECT_EQ(wobble_emote(joined.client, WOBBLE_LOVE), WOBBLE_OK);
  EXPECT_EQ(wobble_rename(joined.client, "Grace"), WOBBLE_OK);
  ASSERT_TRUE(joined.RunUntil([&] { return joined.world->told.size() == 3; }));
  EXPECT_EQ(joined.world->told, (std::vector<std::string>{"hello", "2", "Grace"}));
  for (const std::size_t size : {0U, 201U}) {
    EXPECT_EQ(wobble_say(joined.client, std::string(size, 'a').c_str()), WOBBLE_BAD_VALUE);
  }
  EXPECT_EQ(wobble_rename(joined.client, std::string(33, 'a').c_str()), WOBBLE_BAD_VALUE);
  for (const int emote : {-1, 6}) EXPECT_EQ(wobble_emote(joined.client, emote), WOBBLE_BAD_VALUE);
}

TEST(Wobble, JoinsAgainByItsTicketAndKeepsItsInput) {
  transport::ListenOptions listen;
  listen.secretKey.emplace().fill(7);
  listen.judge = std::make_shared<OnceJudge>();
  Joined joined(listen, "open");
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING)) << joined.Status().reason;
  auto input = Make<wobble_input>();
  input.move_x = 1;
  EXPECT_EQ(wobble_set_input(joined.client, &input), WOBBLE_OK);

  listen.port = joined.world->Port();
  joined.world = nullptr;
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_REJOINING));
  // The second, where a server of another test has the port by now.
  EXPECT_THAT(joined.Status().reason,
              testing::AnyOf(testing::StrEq("connection lost"), testing::StrEq("the server was restarted")));
  EXPECT_EQ(wobble_set_hand(joined.client, nullptr), WOBBLE_NOT_PLAYING);
  EXPECT_EQ(wobble_sample(joined.client, joined.now, nullptr), WOBBLE_OK);
  joined.world = std::make_unique<ScriptedWorld>(listen);
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING)) << joined.Status().reason;
  EXPECT_TRUE(joined.RunUntil([&] { return joined.world->newestInput.move_x() == 127; }));
  auto event = Make<wobble_event>();
  ASSERT_EQ(wobble_next_event(joined.client, &event), WOBBLE_OK);
  EXPECT_EQ(event.kind, WOBBLE_NEW_WORLD);
  EXPECT_STREQ(event.text, "");
  auto statistics = Make<wobble_statistics>();
  ASSERT_EQ(wobble_read_statistics(joined.client, &statistics), WOBBLE_OK);
  EXPECT_EQ(statistics.rejoins, 1U);
}

TEST(Wobble, EndsWhereItIsNotLetInAndWhereItIsNotToJoinAgain) {
  transport::ListenOptions listen;
  listen.judge = std::make_shared<OnceJudge>();
  Joined refused(listen, "close");
  ASSERT_TRUE(refused.RunUntilState(WOBBLE_ENDED));
  EXPECT_EQ(refused.Status().reason, transport::kBadCredentialReason);

  Joined once({}, nullptr, WOBBLE_NO_REJOIN | WOBBLE_SPECTATE);
  ASSERT_TRUE(once.RunUntilState(WOBBLE_PLAYING));
  EXPECT_TRUE(once.world->isSpectator);
  once.world = nullptr;
  ASSERT_TRUE(once.RunUntilState(WOBBLE_ENDED));
  EXPECT_EQ(once.Status().ended_unasked, 1);
}

}  // namespace
}  // namespace wobble::c
