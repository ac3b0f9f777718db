// The client for C, from the shared library as it ships, against a scripted server: what it does, and what it says to
// wrong calls.
#include "client/wobble.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "protocol/random.h"
#include "protocol/version.h"
#include "tests/unit/c/scripted_world.h"

namespace wobble::c {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename Struct>
Struct Make() {
  Struct made{};
  made.struct_size = sizeof made;
  return made;
}

TEST(Wobble, DescribesEveryResultInWordsOfItsOwn) {
  std::set<std::string> texts;
  for (int result = WOBBLE_INTERNAL; result <= WOBBLE_TOO_SMALL; ++result) texts.insert(wobble_describe(result));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(WOBBLE_TOO_SMALL - WOBBLE_INTERNAL + 1));
  EXPECT_STREQ(wobble_describe(4711), wobble_describe(-4711));
  EXPECT_EQ(texts.count(wobble_describe(4711)), 0U);
  EXPECT_STREQ(wobble_version(), kVersion);
}

TEST(Wobble, ConnectRefusesWhatCannotBe) {
  const std::string key(64, 'a'), longText(2000, 'a'), longName(33, 'a'), longPassword(513, 'a');
  const char* good = "127.0.0.1:9";
  using Options = wobble_connect_options;
  struct Case {
    wobble_result result;
    std::function<void(Options&)> spoil;
  };
  const std::vector<Case> cases{
      {WOBBLE_OK, [](Options&) {}},
      {WOBBLE_OK, [&](Options& o) { o.flags = 3, o.name = "Ada", o.password = "x", o.server_key = key.c_str(); }},
      {WOBBLE_BAD_SIZE, [](Options& o) { o.struct_size = 0; }},
      {WOBBLE_BAD_SIZE, [](Options& o) { o.struct_size = sizeof o - 1; }},
      {WOBBLE_BAD_FLAGS, [](Options& o) { o.flags = 4; }},
      {WOBBLE_BAD_FLAGS, [](Options& o) { o.flags = ~0U; }},
      {WOBBLE_NULL, [](Options& o) { o.address = nullptr; }},
      {WOBBLE_BAD_ADDRESS, [](Options& o) { o.address = ""; }},
      {WOBBLE_BAD_ADDRESS, [](Options& o) { o.address = "127.0.0.1"; }},
      {WOBBLE_BAD_ADDRESS, [](Options& o) { o.address = "127.0.0.1:0"; }},
      {WOBBLE_BAD_ADDRESS, [](Options& o) { o.address = "127.0.0.1:65536"; }},
      {WOBBLE_BAD_ADDRESS, [](Options& o) { o.address = "::1:7777"; }},
      {WOBBLE_BAD_ADDRESS, [](Options& o) { o.address = "nobody.invalid:7777"; }},
      {WOBBLE_BAD_ADDRESS, [&](Options& o) { o.address = longText.c_str(); }},
      {WOBBLE_BAD_VALUE, [&](Options& o) { o.name = longName.c_str(); }},
      {WOBBLE_BAD_VALUE, [&](Options& o) { o.name = longText.c_str(); }},
      {WOBBLE_BAD_SECRET, [](Options& o) { o.password = ""; }},
      {WOBBLE_BAD_SECRET, [&](Options& o) { o.password = longPassword.c_str(); }},
      {WOBBLE_BAD_SECRET, [](Options& o) { o.token = "no base64 at all!"; }},
      {WOBBLE_BAD_SECRET, [](Options& o) { o.invite = ""; }},
      {WOBBLE_BAD_SECRET, [](Options& o) { o.password = "x", o.token = "QUJD"; }},
      {WOBBLE_BAD_SECRET, [](Options& o) { o.server_key = "abc"; }},
  };
  for (const Case& each : cases) {
    Options options = Make<Options>();
    options.address = good;
    each.spoil(options);
    auto* client = reinterpret_cast<wobble_client*>(&options);  // anything but null
    EXPECT_EQ(wobble_connect(&options, 0, &client), each.result) << &each - cases.data();
    EXPECT_EQ(client != nullptr, each.result == WOBBLE_OK);
    wobble_destroy(client);
  }
  Options options = Make<Options>();
  options.address = good;
  wobble_client* client = nullptr;
  for (const double now : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e12}) {
    EXPECT_EQ(wobble_connect(&options, now, &client), WOBBLE_BAD_TIME) << now;
  }
  EXPECT_EQ(wobble_connect(&options, 0, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_connect(nullptr, 0, &client), WOBBLE_NULL);
}

TEST(Wobble, NullAndSmallStructsAreRefusedByEveryFunction) {
  Joined joined;
  const float vector[3] = {1, 0, 0};
  wobble_client* const none = nullptr;
  EXPECT_EQ(wobble_update(none, 0), WOBBLE_NULL);
  EXPECT_EQ(wobble_leave(none, 0), WOBBLE_NULL);
  EXPECT_EQ(wobble_set_hand(none, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_push(none, 1, 0, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_push(joined.client, 1, 0, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_cut(none, 1, vector, vector, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_cut(joined.client, 1, vector, nullptr, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_sample(none, 0, nullptr), WOBBLE_NULL);
  wobble_destroy(nullptr);

  // call(client, pointer to the struct).
  const auto check = [&]<typename Struct>(Struct given, auto&& call, bool mayBeNull = false) {
    EXPECT_EQ(call(none, &given), WOBBLE_NULL);
    if (!mayBeNull) {
      EXPECT_EQ(call(joined.client, static_cast<Struct*>(nullptr)), WOBBLE_NULL);
    }
    for (const std::size_t size : {std::size_t{0}, std::size_t{4}, sizeof given - 1}) {
      std::memset(&given, 0x55, sizeof given);
      given.struct_size = static_cast<std::uint32_t>(size);
      const Struct before = given;
      EXPECT_EQ(call(joined.client, &given), WOBBLE_BAD_SIZE) << size;
      EXPECT_EQ(std::memcmp(&given, &before, sizeof given), 0);
    }
  };
  check(Make<wobble_status>(), [](auto* c, auto* s) { return wobble_read_status(c, s); });
  check(Make<wobble_input>(), [](auto* c, auto* s) { return wobble_set_input(c, s); });
  check(
      Make<wobble_hand>(), [](auto* c, auto* s) { return wobble_set_hand(c, s); }, true);
  check(
      Make<wobble_frame>(), [](auto* c, auto* s) { return wobble_sample(c, 20, s); }, true);
  check(Make<wobble_body>(), [](auto* c, auto* s) { return wobble_read_body(c, 0, s); });
  check(Make<wobble_obstacle>(), [](auto* c, auto* s) { return wobble_read_obstacle(c, 0, s); });
  check(Make<wobble_ground>(), [](auto* c, auto* s) { return wobble_read_ground(c, 0, s); });
  check(Make<wobble_event>(), [](auto* c, auto* s) { return wobble_next_event(c, s); });
  check(Make<wobble_statistics>(), [](auto* c, auto* s) { return wobble_read_statistics(c, s); });
}

// A program that was compiled with a later header passes larger structs: what this library does not know stays as it
// is.
TEST(Wobble, WritesNothingBeyondWhatItKnows) {
  Joined joined;
  struct Later {
    wobble_status known{};
    std::array<unsigned char, 64> unknown{};
  } later;
  later.unknown.fill(0xAB);
  later.known.struct_size = sizeof later;
  EXPECT_EQ(wobble_read_status(joined.client, &later.known), WOBBLE_OK);
  EXPECT_EQ(later.known.struct_size, sizeof later);
  for (const unsigned char byte : later.unknown) EXPECT_EQ(byte, 0xAB);
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
  EXPECT_EQ(status.hands, std::uint32_t{WOBBLE_MAY_GRAB});
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
  const float direction[3] = {0, 0, 1}, nothing[3] = {0, 0, 0}, broken[3] = {0, kNan, 0};
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
  EXPECT_STREQ(joined.Status().reason, "connection lost");
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

// Wrong calls of all kinds, in any order: none crashes, none reaches the server, and the client still plays.
TEST(Wobble, BearsAnyCallsInAnyOrder) {
  constexpr std::uint64_t kSeed = 26;
  constexpr int kCalls = 20'000;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  protocol::Random random(kSeed);
  Joined joined;
  ASSERT_TRUE(joined.RunUntilState(WOBBLE_PLAYING));
  std::array<float, 64> positions{}, normals{};
  std::array<std::uint32_t, 64> indices{};
  const auto choose = [&](auto... values) {
    const std::array all{values...};
    return all[random.Next() % all.size()];
  };
  const auto number = [&] { return choose(0.0F, 1.0F, -1.0F, 0.5F, 2.0F, kNan, HUGE_VALF, -3e38F, 1e-40F); };
  const auto count = [&] { return choose(0U, 1U, 2U, 3U, 4U, 8U, 4095U, 4096U, 65536U, ~0U); };
  // Sizes only that the memory has: a pointer is trusted to have what it says.
  const auto size = [&](std::size_t whole) {
    return choose(0U, 3U, static_cast<unsigned>(whole) - 1, static_cast<unsigned>(whole));
  };
  const auto make = [&](auto made) {
    std::memset(&made, choose(0, 0, 0xFF), sizeof made);
    made.struct_size = size(sizeof made);
    return made;
  };
  std::set<wobble_result> results;
  for (int i = 0; i < kCalls; ++i) {
    wobble_client* client = random.Next() % 20 == 0 ? nullptr : joined.client;
    const double now = choose(joined.now, joined.now, joined.now - 1, std::nan(""), HUGE_VAL, -1e300);
    const float a[3] = {number(), number(), number()}, b[3] = {number(), number(), number()};
    wobble_result result = WOBBLE_OK;
    switch (random.Next() % 12) {
      case 0:
        result = wobble_update(client, now);
        break;
      case 1: {
        auto input = make(wobble_input{});
        input.buttons = count(), input.move_x = number(), input.move_y = number();
        result = wobble_set_input(client, &input);
        break;
      }
      case 2: {
        auto hand = make(wobble_hand{});
        hand.body = count(), hand.vertex = count();
        std::memcpy(hand.target, a, sizeof a);
        result = wobble_set_hand(client, choose(&hand, &hand, static_cast<wobble_hand*>(nullptr)));
        break;
      }
      case 3:
        result = wobble_push(client, count(), count(), choose(a, b));
        break;
      case 4:
        result = wobble_cut(client, count(), a, b, choose(a, static_cast<const float*>(nullptr)));
        break;
      case 5: {
        auto frame = make(wobble_frame{});
        frame.vertex_capacity = choose(0U, 7U, 8U, 20U), frame.index_capacity = choose(0U, 23U, 24U, 64U);
        frame.positions = choose(positions.data(), static_cast<float*>(nullptr));
        frame.normals = choose(normals.data(), static_cast<float*>(nullptr));
        frame.indices = choose(indices.data(), static_cast<std::uint32_t*>(nullptr));
        result = wobble_sample(client, now, choose(&frame, &frame, static_cast<wobble_frame*>(nullptr)));
        break;
      }
      case 6: {
        auto body = make(wobble_body{});
        result = wobble_read_body(client, count(), &body);
        break;
      }
      case 7: {
        auto obstacle = make(wobble_obstacle{});
        result = wobble_read_obstacle(client, count(), &obstacle);
        break;
      }
      case 8: {
        auto ground = make(wobble_ground{});
        result = wobble_read_ground(client, count(), &ground);
        break;
      }
      case 9: {
        auto event = make(wobble_event{});
        result = wobble_next_event(client, &event);
        break;
      }
      case 10: {
        auto statistics = make(wobble_statistics{});
        result = wobble_read_statistics(client, &statistics);
        break;
      }
      default: {
        auto status = make(wobble_status{});
        result = wobble_read_status(client, &status);
      }
    }
    results.insert(result);
    if (i % 50 == 0) joined.Run(1);
  }
  for (const wobble_result expected : {WOBBLE_OK, WOBBLE_NO_EVENT, WOBBLE_TOO_SMALL, WOBBLE_NULL, WOBBLE_BAD_SIZE,
                                       WOBBLE_BAD_FLAGS, WOBBLE_BAD_VALUE, WOBBLE_BAD_TIME, WOBBLE_BAD_INDEX}) {
    EXPECT_TRUE(results.count(expected) == 1) << wobble_describe(expected);
  }
  EXPECT_EQ(results.count(WOBBLE_INTERNAL) + results.count(WOBBLE_NO_MEMORY), 0U);
  joined.Run(60);
  EXPECT_EQ(joined.Status().state, WOBBLE_PLAYING) << joined.Status().reason;
  EXPECT_EQ(joined.world->badMessages, 0);
  EXPECT_GT(joined.world->commands, 0);
}

}  // namespace
}  // namespace wobble::c
