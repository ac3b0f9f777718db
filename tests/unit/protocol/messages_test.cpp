// Every kind of message, whole, cut short at every length and changed at every byte: parsing never reads outside, and
// a message that it calls good can be read in full.
#include "protocol/messages.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/damage.h"
#include "tests/unit/protocol/parse_messages.h"

namespace wobble::protocol {
namespace {

using parsing::ParseAs;
using test::Bytes;

Message MakeTriangle() {
  const std::vector<Vector3> rest{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 2, 3}, {1, 3, 2}};
  return MakeBlueprint({.name = "tetrahedron", .rest = rest, .faces = faces, .size = 1.2F});
}

Message MakeWorkshop() {
  const std::vector<Vector3> rest{{-1, 0, 0}, {1, 0, 0}};
  const std::vector<std::array<std::uint16_t, 2>> edges{{0, 1}};
  const std::vector<wire::ParticleTag> particles{{0.5F, 7, 12, false}, {1, 0, 13, true}};
  const std::vector<wire::SpringTag> springs{{100, 1, 2, 7, 3}};
  return MakeBlueprint({.name = "workshop", .rest = rest, .edges = edges, .particles = particles, .springs = springs});
}

Message MakeChain() {
  const std::vector<Vector3> rest{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  const std::vector<std::array<std::uint16_t, 2>> edges{{0, 1}, {1, 2}};
  return MakeBlueprint({.name = "chain", .rest = rest, .size = 0.8F, .edges = edges});
}

struct Kind {
  const char* name;
  char side;  // the sender: c or s; b: a blueprint, put together from chunks
  Message bytes;
};

std::vector<Kind> MakeEveryKind() {
  const std::vector<wire::InputFrame> frames{{104, 127, -127, 7}, {103, 0, 0, 0}, {102, 1, -1, 2}, {101, 5, 6, 1}};
  WelcomeFields welcome{.clientId = 7,
                        .ownBody = 9,
                        .tick = 1000,
                        .tickHz = 60,
                        .snapshotHz = 30,
                        .scene = "arena",
                        .blueprintCount = 2,
                        .obstacles = {}};
  welcome.obstacles = {{wire::ObstacleKind::Plane, {0, 0, 1}, {0, 0, 0}, 0},
                       {wire::ObstacleKind::Capsule, {1, 2, 3}, {4, 5, 6}, 0.5F}};
  welcome.heightFields = {{{1, 2, 3}, 0.5F, -1, 0.01F, 3, 2}};
  welcome.hands = kMayGrab | kMayBuild;
  welcome.reach = 2.5F;
  welcome.game = "sumo";
  welcome.description = "a ring, and who falls off has lost";
  welcome.talk = kMaySay | kMayEmote;
  const Bytes part(64, 0xA5);
  const std::vector<std::uint64_t> kept{0x1122334455667788U, 1};
  const wire::Hand hand({1, 2, 3}, 4, 5, 6);
  const std::vector<ForceField> forces{{wire::ForceKind::Gas, {{1, 2, 3}, {-4, 5, 6}}},
                                       {wire::ForceKind::Weight, {{}, {}}}};
  return {
      {"hello", 'c', MakeHello("Ada", wire::Role::Player)},
      {"hello of a bot", 'c', MakeHello("bot 1", wire::Role::Player, {}, kProtocolVersion, kSchemaHash, true)},
      {"hello with kept blueprints", 'c', MakeHello("Ada", wire::Role::Player, kept)},
      {"input", 'c', MakeInput({.frames = frames, .ackedSequence = 77, .ackedHistory = 0xF0F0F0F0F0F0F0F0U})},
      {"input with a hand", 'c',
       MakeInput({.frames = frames, .ackedSequence = 77, .ackedHistory = 1, .hand = &hand, .downloaded = 98765})},
      {"push", 'c', MakePush(3, 17, {0, 1, 0.5F})},
      {"cut", 'c', MakeCut(3, {1, 2, 3}, {4, 5, 6}, {7, 8, 9})},
      {"inspect", 'c', MakeInspect(3)},
      {"order", 'c', MakeOrder("kick 7")},
      {"say", 'c', MakeSay("who plays sumo?")},
      {"emote", 'c', MakeEmote(wire::EmoteKind::Cheer)},
      {"rename", 'c', MakeRename("Bob")},
      {"tune", 'c', MakeTune(wire::TuneKind::TimeRate, {0.5F, 0, 0})},
      {"build", 'c', MakeBuild({.kind = wire::BuildKind::AddSpring, .a = 3, .b = 4, .stiffness = 200})},
      {"client goodbye", 'c', MakeClientGoodbye(wire::GoodbyeReason::Left, "bye")},
      {"welcome", 's', MakeWelcome(welcome)},
      {"blueprint chunk", 's', MakeBlueprintChunk(1, 0x1122334455667788U, 1000, 128, part)},
      {"kept blueprint", 's', MakeBlueprintChunk(1, 0x1122334455667788U, 1000, 1000, {})},
      {"height rows", 's', MakeHeightRows(1, 2, std::vector<std::uint16_t>{0, 1, 65535, 7})},
      {"event", 's', MakeEvent(wire::EventKind::Join, 1001, 7, 9, "Ada")},
      {"said", 's', MakeEvent(wire::EventKind::Said, 1001, 7, 9, "who plays sumo?")},
      {"emote of a player", 's', MakeEvent(wire::EventKind::Emote, 1001, 7, 9, "", wire::EmoteKind::Sad)},
      {"tuning", 's', MakeTuning({.stiffness = 2, .timeRate = 0.25F, .may = 7})},
      {"forces", 's', MakeForces(3, 1001, 1, forces)},
      {"scoreboard", 's',
       MakeScoreboard({.round = 2, .secondsLeft = 61, .winner = 7, .scores = {{7, 3, 1}, {8, 0, 0}}})},
      {"scoreboard of sides", 's',
       MakeScoreboard({.phase = wire::GamePhase::Over,
                       .scores = {{7, 3, 1}, {8, 0, 0}},
                       .rounds = 3,
                       .seats = {{1, true, false}, {2, true, true}},
                       .sides = {{3, 1}, {0, 0}},
                       .winningSide = 1,
                       .object = 9,
                       .bearer = 8})},
      {"notice", 's', MakeNotice("the spring would be too stiff")},
      {"next scene", 's', MakeNextScene("sumo")},
      {"server goodbye", 's', MakeServerGoodbye(wire::GoodbyeReason::BadMessages, "20 in a second")},
      {"blueprint", 'b', MakeTriangle()},
      {"blueprint of edges", 'b', MakeChain()},
      {"blueprint of the workshop", 'b', MakeWorkshop()},
  };
}

TEST(Messages, EveryKindIsParsedByItsReceiverAlone) {
  for (const Kind& kind : MakeEveryKind()) {
    SCOPED_TRACE(kind.name);
    EXPECT_EQ(ParseAs(kind.side, kind.bytes), ParseResult::kOk);
  }
}

TEST(Messages, EveryTruncationIsRefused) {
  for (const Kind& kind : MakeEveryKind()) {
    SCOPED_TRACE(kind.name);
    int parsed = 0;
    std::size_t longest = 0;
    test::ForEachTruncation(kind.bytes, [&](std::span<const std::uint8_t> cut) {
      if (ParseAs(kind.side, cut) == ParseResult::kOk) ++parsed, longest = cut.size();
    });
    // The last bytes may be padding that nothing points to; all others are needed.
    EXPECT_LE(parsed, 3) << "last at " << longest << " of " << kind.bytes.size();
  }
}

TEST(Messages, EveryChangedByteIsSafe) {
  for (const Kind& kind : MakeEveryKind()) {
    SCOPED_TRACE(kind.name);
    std::array<int, kParseResultCount> counts{};
    for (const char side : {'c', 's', 'b'}) {  // also as the wrong kinds
      test::ForEachChangedByte(kind.bytes, [&](std::span<const std::uint8_t> changed) {
        ++counts[static_cast<std::size_t>(ParseAs(side, changed))];
      });
    }
    EXPECT_GT(counts[static_cast<std::size_t>(ParseResult::kOk)], 0);
    EXPECT_GT(counts[static_cast<std::size_t>(ParseResult::kMalformed)], 0);
    EXPECT_GT(counts[static_cast<std::size_t>(ParseResult::kMissingField)], 0);
  }
}

TEST(Messages, RandomBytesAreSafe) {
  std::mt19937 random(41);
  for (int i = 0; i < 100000; ++i) {
    Bytes bytes(random() % 128);
    // Small numbers are more often valid offsets.
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() % (i % 2 == 0 ? 256 : 16));
    for (const char side : {'c', 's', 'b'}) ParseAs(side, bytes);
  }
}

TEST(Messages, SeveralChangesAtOnceAreSafe) {
  std::mt19937 random(42);
  for (const Kind& kind : MakeEveryKind()) {
    SCOPED_TRACE(kind.name);
    for (int i = 0; i < 20000; ++i) {
      Bytes bytes = kind.bytes;
      for (auto change = 2 + random() % 6; change > 0; --change) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random() % 4 == 0 ? random() : random() % 32);
      }
      ParseAs(kind.side, bytes);
    }
  }
}

TEST(Messages, AMisalignedBufferIsRefusedUnread) {
  for (const Kind& kind : MakeEveryKind()) {
    Bytes shifted(kind.bytes.size() + 8);
    for (std::size_t shift = 1; shift < 8; ++shift) {
      std::copy(kind.bytes.begin(), kind.bytes.end(), shifted.begin() + static_cast<std::ptrdiff_t>(shift));
      EXPECT_EQ(ParseAs(kind.side, std::span(shifted).subspan(shift, kind.bytes.size())), ParseResult::kMalformed)
          << kind.name << " shifted by " << shift;
    }
  }
}

TEST(Messages, WhatIsTooLargeIsRefused) {
  EXPECT_EQ(ParseAs('c', Bytes(kMaxClientMessageBytes + 1)), ParseResult::kTooLarge);
  EXPECT_EQ(ParseAs('c', Bytes(kMaxClientMessageBytes)), ParseResult::kMalformed);
  EXPECT_EQ(ParseAs('s', Bytes(kMaxServerMessageBytes + 1)), ParseResult::kTooLarge);
  EXPECT_EQ(ParseAs('s', Bytes(kMaxServerMessageBytes)), ParseResult::kMalformed);
  EXPECT_EQ(ParseAs('b', Bytes(kMaxBlueprintBytes + 1)), ParseResult::kTooLarge);
  EXPECT_EQ(ParseAs('b', Bytes(kMaxBlueprintBytes)), ParseResult::kMalformed);
  for (const char side : {'c', 's', 'b'}) EXPECT_EQ(ParseAs(side, {}), ParseResult::kMalformed);
}

TEST(Messages, FieldsComeBack) {
  const wire::ClientMessage* client = nullptr;
  const Message hello = MakeHello("Grüße", wire::Role::Spectator);
  ASSERT_EQ(ParseClientMessage(hello, client), ParseResult::kOk);
  EXPECT_EQ(client->body_as_Hello()->protocol_version(), kProtocolVersion);
  EXPECT_EQ(client->body_as_Hello()->schema_hash(), kSchemaHash);
  EXPECT_EQ(client->body_as_Hello()->name()->str(), "Grüße");
  EXPECT_EQ(client->body_as_Hello()->role(), wire::Role::Spectator);

  const std::vector<wire::InputFrame> frames{{104, 127, -127, 7}, {103, 1, 2, 4}};
  const Message input =
      MakeInput({.frames = frames, .ackedSequence = 77, .ackedHistory = 0x8000000000000001U, .stalls = 12});
  EXPECT_LT(input.size(), 200U);
  ASSERT_EQ(ParseClientMessage(input, client), ParseResult::kOk);
  EXPECT_EQ(client->body_as_Input()->frames()->Get(0)->tick(), 104U);
  EXPECT_EQ(client->body_as_Input()->frames()->Get(0)->move_y(), -127);
  EXPECT_EQ(client->body_as_Input()->frames()->Get(1)->buttons(), 4);
  EXPECT_EQ(client->body_as_Input()->acked_sequence(), 77U);
  EXPECT_EQ(client->body_as_Input()->stalls(), 12U);
  EXPECT_EQ(client->body_as_Input()->acked_history(), 0x8000000000000001U);

  const wire::ServerMessage* server = nullptr;
  const Message welcome = MakeWelcome({.clientId = 7,
                                       .ownBody = 9,
                                       .tick = 1000,
                                       .tickHz = 60,
                                       .snapshotHz = 30,
                                       .scene = "arena",
                                       .blueprintCount = 2,
                                       .obstacles = {{wire::ObstacleKind::Box, {1, 2, 3}, {4, 5, 6}, 0}}});
  ASSERT_EQ(ParseServerMessage(welcome, server), ParseResult::kOk);
  EXPECT_EQ(server->body_as_Welcome()->scene()->str(), "arena");
  EXPECT_EQ(server->body_as_Welcome()->tick_hz(), 60);
  EXPECT_EQ(server->body_as_Welcome()->obstacles()->Get(0)->b().z(), 6.0F);
  EXPECT_EQ(ParseAs('s', MakeWelcome({.clientId = 1, .tickHz = 60, .snapshotHz = 30, .scene = "", .obstacles = {}})),
            ParseResult::kOk)
      << "no obstacles at all";

  const wire::Blueprint* blueprint = nullptr;
  const Message triangle = MakeTriangle();
  ASSERT_EQ(ParseBlueprint(triangle, blueprint), ParseResult::kOk);
  EXPECT_EQ(blueprint->rest()->Get(3)->z(), -1.0F);
  EXPECT_EQ(blueprint->faces()->Get(2)->b(), 3);
}

TEST(Messages, ForcesComeBackInStepsOfTheLargest) {
  const std::vector<ForceField> fields{{wire::ForceKind::Gas, {{254, -127, 0}}}, {wire::ForceKind::Elastic, {{}}}};
  const Message message = MakeForces(3, 1001, 2, fields);
  const wire::ServerMessage* parsed = nullptr;
  ASSERT_EQ(ParseServerMessage(message, parsed), ParseResult::kOk);
  const wire::Forces& forces = *parsed->body_as_Forces();
  ASSERT_EQ(forces.sets()->size(), 1U) << "what is zero all over is not sent";
  const wire::ForceSet& set = *forces.sets()->Get(0);
  EXPECT_EQ(set.kind(), wire::ForceKind::Gas);
  EXPECT_EQ(set.scale(), 254);
  EXPECT_EQ(std::vector<int>(set.values()->begin(), set.values()->end()), (std::vector<int>{127, -64, 0}));
}

TEST(Messages, HashIsFnv1a) {
  const Bytes text{'f', 'o', 'o', 'b', 'a', 'r'};
  EXPECT_EQ(HashBytes({}), 0xCBF29CE484222325U);
  EXPECT_EQ(HashBytes(text), 0x85944171F73967E8U);
}

TEST(Messages, NamesAreDistinct) {
  for (std::size_t i = 0; i < kParseResultCount; ++i) EXPECT_STRNE(Name(static_cast<ParseResult>(i)), "unknown");
  EXPECT_STREQ(Name(static_cast<ParseResult>(kParseResultCount)), "unknown");
}

}  // namespace
}  // namespace wobble::protocol
