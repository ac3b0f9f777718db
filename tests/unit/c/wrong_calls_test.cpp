// Wrong calls of the client for C: each is answered with a code and does no harm.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "client/c/structs.h"
#include "client/wobble.h"
#include "protocol/random.h"
#include "tests/unit/c/scripted_world.h"

namespace wobble::c {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(WrongCalls, ToConnectAreRefused) {
  const std::string key(64, 'a'), longText(2000, 'a'), longName(33, 'a'), longPassword(513, 'a');
  const char* good = "127.0.0.1:9";
  using Options = wobble_connect_options;
  struct Case {
    wobble_result result;
    std::function<void(Options&)> spoil;
  };
  const std::vector<Case> cases{
      {WOBBLE_OK, [](Options&) {}},
      {WOBBLE_OK, [&](Options& o) { o.flags = 7, o.name = "Ada", o.password = "x", o.server_key = key.c_str(); }},
      {WOBBLE_OK, [](Options& o) { o.token = "QUJD"; }},
      {WOBBLE_OK, [](Options& o) { o.invite = "QUJD"; }},
      {WOBBLE_BAD_SIZE, [](Options& o) { o.struct_size = 0; }},
      {WOBBLE_BAD_SIZE, [](Options& o) { o.struct_size = sizeof o - 1; }},
      {WOBBLE_BAD_FLAGS, [](Options& o) { o.flags = 8; }},
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

TEST(WrongCalls, NullAndSmallStructsAreRefusedByEveryFunction) {
  Joined joined;
  const float vector[3] = {1, 0, 0};
  wobble_client* const none = nullptr;
  EXPECT_EQ(wobble_update(none, 0), WOBBLE_NULL);
  EXPECT_EQ(wobble_leave(none, 0), WOBBLE_NULL);
  EXPECT_EQ(wobble_set_hand(none, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_push(none, 1, 0, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_push(joined.client, 1, 0, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_say(none, "hello"), WOBBLE_NULL);
  EXPECT_EQ(wobble_say(joined.client, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_rename(none, "Ada"), WOBBLE_NULL);
  EXPECT_EQ(wobble_rename(joined.client, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_emote(none, WOBBLE_WAVE), WOBBLE_NULL);
  EXPECT_EQ(wobble_cut(none, 1, vector, vector, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_cut(joined.client, 1, vector, nullptr, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_tune(none, 0, vector), WOBBLE_NULL);
  EXPECT_EQ(wobble_tune(joined.client, 0, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_order(none, "x"), WOBBLE_NULL);
  EXPECT_EQ(wobble_order(joined.client, nullptr), WOBBLE_NULL);
  EXPECT_EQ(wobble_sample(none, 0, nullptr), WOBBLE_NULL);
  wobble_destroy(nullptr);

  // call(client, pointer to the struct).
  const auto check = [&]<typename Struct>(Struct given, auto&& call, bool mayBeNull = false) {
    EXPECT_EQ(call(none, &given), WOBBLE_NULL);
    if (!mayBeNull) {
      EXPECT_EQ(call(joined.client, static_cast<Struct*>(nullptr)), WOBBLE_NULL);
    }
    for (const std::size_t size : {std::size_t{0}, std::size_t{4}, kFirstSize<Struct> - 1}) {
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
  check(Make<wobble_workshop>(), [](auto* c, auto* s) { return wobble_read_workshop(c, s); });
  check(Make<wobble_particle>(), [](auto* c, auto* s) { return wobble_read_particle(c, 0, s); });
  check(Make<wobble_spring>(), [](auto* c, auto* s) { return wobble_read_spring(c, 0, s); });
  check(Make<wobble_change>(), [](auto* c, auto* s) { return wobble_build(c, s); });
  check(Make<wobble_tuning>(), [](auto* c, auto* s) { return wobble_read_tuning(c, s); });
  check(Make<wobble_scoreboard>(), [](auto* c, auto* s) { return wobble_read_scoreboard(c, s); });
  check(Make<wobble_score>(), [](auto* c, auto* s) { return wobble_read_score(c, 0, s); });
}

// A program that was compiled with a later header passes larger structs: what this library does not know stays as it
// is.
TEST(WrongCalls, WritesNothingBeyondWhatItKnows) {
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

// None crashes, none reaches the server, and the client still plays.
TEST(WrongCalls, InAnyOrderDoNoHarm) {
  constexpr std::uint64_t kSeed = 26;
  constexpr int kCalls = 20'000;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  protocol::Random random(kSeed);
  Joined joined;
  joined.world->hasWorkshop = true;
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
    switch (random.Next() % 15) {
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
      case 11: {
        auto change = make(wobble_change{});
        change.kind = static_cast<std::int32_t>(count()), change.a = count(), change.mass = number();
        change.fixed = choose(0, 1, 2);
        std::memcpy(change.at, a, sizeof a);
        result = wobble_build(client, &change);
        break;
      }
      case 12:
        result =
            wobble_tune(client, static_cast<std::int32_t>(count()), choose(a, b, static_cast<const float*>(nullptr)));
        break;
      case 13: {
        auto part = make(wobble_particle{});
        auto end = make(wobble_spring{});
        auto score = make(wobble_score{});
        result = choose(wobble_read_particle(client, count(), &part), wobble_read_spring(client, count(), &end),
                        wobble_read_score(client, count(), &score));
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
