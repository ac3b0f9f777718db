// Every kind of message, whole, cut short at every length and changed at every byte: parsing never reads outside, and
// what it calls good can be read in full. Read() touches every accessor, so AddressSanitizer sees what verification
// would have let through.
#include "protocol/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/damage.h"

namespace wobble::protocol {
namespace {

using test::Bytes;

// Where Read() puts what it reads, so that no read is optimised away.
volatile std::uint64_t g_read = 0;

void Touch(std::uint64_t value) { g_read = g_read + value; }
void Touch(const wire::Vec3& v) { Touch(static_cast<std::uint64_t>(std::isfinite(v.x() + v.y() + v.z()))); }
void Touch(const flatbuffers::String& text) {
  for (const char c : text) Touch(static_cast<std::uint8_t>(c));
  EXPECT_EQ(text.c_str()[text.size()], '\0');
}

void ExpectFinite(const wire::Vec3& v) {
  EXPECT_TRUE(std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()));
}

void Read(const wire::Goodbye& goodbye) {
  Touch(*goodbye.detail());
  EXPECT_STRNE(Name(goodbye.reason()), "unknown reason");
}

void Read(const wire::ClientMessage& message) {
  if (const auto* hello = message.body_as_Hello()) {
    Touch(hello->protocol_version());
    Touch(hello->schema_hash());
    Touch(*hello->name());
    EXPECT_LE(hello->name()->size(), kMaxNameBytes);
    EXPECT_LE(hello->role(), wire::Role::MAX);
  } else if (const auto* input = message.body_as_Input()) {
    EXPECT_LE(input->frames()->size(), kMaxInputFrames);
    EXPECT_GT(input->frames()->size(), 0U);
    for (const wire::InputFrame* frame : *input->frames()) {
      Touch(frame->tick());
      EXPECT_GE(frame->move_x(), -127);
      EXPECT_GE(frame->move_y(), -127);
      EXPECT_LE(frame->buttons(), 7);
    }
    Touch(input->acked_sequence());
    Touch(input->acked_history());
    if (input->hand() != nullptr) ExpectFinite(input->hand()->target());
  } else if (const auto* push = message.body_as_Push()) {
    ExpectFinite(*push->direction());
  } else if (const auto* cut = message.body_as_Cut()) {
    for (const wire::Vec3* place : {cut->eye(), cut->from(), cut->to()}) ExpectFinite(*place);
  } else if (const auto* inspect = message.body_as_Inspect()) {
    Touch(inspect->body());
  } else if (const auto* tune = message.body_as_Tune()) {
    EXPECT_LE(tune->kind(), wire::TuneKind::MAX);
    ExpectFinite(*tune->value());
  } else if (const auto* build = message.body_as_Build()) {
    EXPECT_LE(build->kind(), wire::BuildKind::MAX);
    ExpectFinite(*build->at());
    for (const float value : {build->mass(), build->stiffness(), build->damping(), build->rest_length()}) {
      EXPECT_TRUE(std::isfinite(value));
    }
  } else if (const auto* goodbye = message.body_as_Goodbye()) {
    Read(*goodbye);
  } else {
    ADD_FAILURE() << "ok without a body";
  }
}

void Read(const wire::ServerMessage& message) {
  if (const auto* welcome = message.body_as_Welcome()) {
    Touch(welcome->client_id() + welcome->own_body() + welcome->tick());
    EXPECT_GT(welcome->tick_hz(), 0);
    EXPECT_GT(welcome->snapshot_hz(), 0);
    EXPECT_LE(welcome->blueprint_count(), kMaxBlueprints);
    Touch(*welcome->scene());
    for (const wire::HeightField* field : *welcome->height_fields()) {
      EXPECT_LE(field->columns(), kMaxFieldNodes);
      EXPECT_GE(field->rows(), 2);
      EXPECT_TRUE(std::isfinite(field->corner().z() + field->low() + field->step() * 65535.0F));
    }
    for (const wire::Obstacle* obstacle : *welcome->obstacles()) {
      EXPECT_LE(obstacle->kind(), wire::ObstacleKind::MAX);
      EXPECT_TRUE(std::isfinite(obstacle->radius()));
      Touch(obstacle->a());
      Touch(obstacle->b());
    }
  } else if (const auto* chunk = message.body_as_BlueprintChunk()) {
    Touch(chunk->blueprint() + chunk->hash());
    EXPECT_LE(chunk->total(), kMaxBlueprintBytes);
    EXPECT_LE(std::uint64_t{chunk->offset()} + chunk->bytes()->size(), chunk->total());
    EXPECT_LT(chunk->generation(), kGenerations);
    for (const std::uint8_t byte : *chunk->bytes()) Touch(byte);
  } else if (const auto* rows = message.body_as_HeightRows()) {
    EXPECT_LE(rows->heights()->size(), kMaxRowsHeights);
    for (const std::uint16_t height : *rows->heights()) Touch(height);
  } else if (const auto* event = message.body_as_Event()) {
    EXPECT_LE(event->kind(), wire::EventKind::MAX);
    Touch(event->tick() + event->client_id() + event->body());
    Touch(*event->name());
  } else if (const auto* tuning = message.body_as_Tuning()) {
    ExpectFinite(*tuning->gravity());
    EXPECT_TRUE(tuning->time_rate() > 0 && tuning->time_rate() <= 1 && tuning->stiffness() > 0);
  } else if (const auto* forces = message.body_as_Forces()) {
    EXPECT_GT(forces->stride(), 0);
    for (const wire::ForceSet* set : *forces->sets()) {
      EXPECT_LE(set->kind(), wire::ForceKind::MAX);
      EXPECT_LE(set->values()->size(), 3 * kMaxShownForces);
      for (const std::int8_t value : *set->values()) Touch(static_cast<std::uint8_t>(value));
    }
  } else if (const auto* board = message.body_as_Scoreboard()) {
    EXPECT_LE(board->phase(), wire::GamePhase::MAX);
    for (const wire::Score* score : *board->scores()) Touch(score->points());
  } else if (const auto* notice = message.body_as_Notice()) {
    EXPECT_LE(notice->text()->size(), kMaxNoticeBytes);
    Touch(*notice->text());
  } else if (const auto* goodbye = message.body_as_Goodbye()) {
    Read(*goodbye);
  } else {
    ADD_FAILURE() << "ok without a body";
  }
}

void Read(const wire::Blueprint& blueprint) {
  Touch(*blueprint.name());
  EXPECT_TRUE(blueprint.size() > 0 && std::isfinite(blueprint.size()));
  EXPECT_LE(blueprint.rest()->size(), kMaxBodyVertices);
  for (const wire::Vec3* vertex : *blueprint.rest()) ExpectFinite(*vertex);
  if (blueprint.particles() != nullptr) {
    EXPECT_EQ(blueprint.particles()->size(), blueprint.rest()->size());
    for (const wire::ParticleTag* tag : *blueprint.particles()) EXPECT_TRUE(std::isfinite(tag->mass()));
  }
  if (blueprint.springs() != nullptr) {
    EXPECT_EQ(blueprint.springs()->size(), blueprint.edges() == nullptr ? 0 : blueprint.edges()->size());
    for (const wire::SpringTag* tag : *blueprint.springs()) EXPECT_TRUE(std::isfinite(tag->stiffness()));
  }
  for (const wire::Face* face : *blueprint.faces()) {
    EXPECT_LT(std::max({face->a(), face->b(), face->c()}), blueprint.rest()->size());
  }
  if (blueprint.edges() != nullptr) {
    EXPECT_LE(blueprint.edges()->size(), kMaxBlueprintEdges);
    for (const wire::Edge* edge : *blueprint.edges()) {
      EXPECT_LT(std::max(edge->a(), edge->b()), blueprint.rest()->size());
    }
  }
}

// The three parsers under one name; each sets its message only when the result is kOk.
ParseResult Parse(std::span<const std::uint8_t> bytes, const wire::ClientMessage*& message) {
  return ParseClientMessage(bytes, message);
}
ParseResult Parse(std::span<const std::uint8_t> bytes, const wire::ServerMessage*& message) {
  return ParseServerMessage(bytes, message);
}
ParseResult Parse(std::span<const std::uint8_t> bytes, const wire::Blueprint*& message) {
  return ParseBlueprint(bytes, message);
}

template <class Root>
ParseResult ParseAndRead(std::span<const std::uint8_t> bytes) {
  const Root* message = nullptr;
  const ParseResult result = Parse(bytes, message);
  EXPECT_EQ(message != nullptr, result == ParseResult::kOk) << Name(result);
  if (message != nullptr) Read(*message);
  return result;
}

ParseResult ParseAs(char side, std::span<const std::uint8_t> bytes) {
  if (side == 'c') return ParseAndRead<wire::ClientMessage>(bytes);
  if (side == 's') return ParseAndRead<wire::ServerMessage>(bytes);
  return ParseAndRead<wire::Blueprint>(bytes);
}

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
  char side;  // who sends it: c, s; b: a blueprint, put together from chunks
  Message bytes;
};

std::vector<Kind> MakeEveryKind() {
  const std::vector<wire::InputFrame> frames{{104, 127, -127, 7}, {103, 0, 0, 0}, {102, 1, -1, 2}, {101, 5, 6, 1}};
  WelcomeFields welcome{7, 9, 1000, 60, 30, "arena", 2, {}};
  welcome.obstacles = {{wire::ObstacleKind::Plane, {0, 0, 1}, {0, 0, 0}, 0},
                       {wire::ObstacleKind::Capsule, {1, 2, 3}, {4, 5, 6}, 0.5F}};
  welcome.heightFields = {{{1, 2, 3}, 0.5F, -1, 0.01F, 3, 2}};
  welcome.hands = kMayGrab | kMayBuild;
  welcome.reach = 2.5F;
  welcome.game = "sumo";
  const Bytes part(64, 0xA5);
  const wire::Hand hand({1, 2, 3}, 4, 5, 6);
  const std::vector<ForceField> forces{{wire::ForceKind::Gas, {{1, 2, 3}, {-4, 5, 6}}},
                                       {wire::ForceKind::Weight, {{}, {}}}};
  return {
      {"hello", 'c', MakeHello("Ada", wire::Role::Player)},
      {"input", 'c', MakeInput(frames, 77, 0xF0F0F0F0F0F0F0F0U)},
      {"input with a hand", 'c', MakeInput(frames, 77, 1, &hand)},
      {"push", 'c', MakePush(3, 17, {0, 1, 0.5F})},
      {"cut", 'c', MakeCut(3, {1, 2, 3}, {4, 5, 6}, {7, 8, 9})},
      {"inspect", 'c', MakeInspect(3)},
      {"tune", 'c', MakeTune(wire::TuneKind::TimeRate, {0.5F, 0, 0})},
      {"build", 'c', MakeBuild({.kind = wire::BuildKind::AddSpring, .a = 3, .b = 4, .stiffness = 200})},
      {"client goodbye", 'c', MakeClientGoodbye(wire::GoodbyeReason::Left, "bye")},
      {"welcome", 's', MakeWelcome(welcome)},
      {"blueprint chunk", 's', MakeBlueprintChunk(1, 0x1122334455667788U, 1000, 128, part)},
      {"height rows", 's', MakeHeightRows(1, 2, std::vector<std::uint16_t>{0, 1, 65535, 7})},
      {"event", 's', MakeEvent(wire::EventKind::Join, 1001, 7, 9, "Ada")},
      {"tuning", 's', MakeTuning({.stiffness = 2, .timeRate = 0.25F, .may = 7})},
      {"forces", 's', MakeForces(3, 1001, 1, forces)},
      {"scoreboard", 's',
       MakeScoreboard({.round = 2, .secondsLeft = 61, .winner = 7, .scores = {{7, 3, 1}, {8, 0, 0}}})},
      {"notice", 's', MakeNotice("the spring would be too stiff")},
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
    // What a builder puts last may be padding that nothing points to; more than that is needed.
    EXPECT_LE(parsed, 3) << "last at " << longest << " of " << kind.bytes.size();
  }
}

TEST(Messages, EveryChangedByteIsSafe) {
  for (const Kind& kind : MakeEveryKind()) {
    SCOPED_TRACE(kind.name);
    std::array<int, kParseResultCount> counts{};
    for (const char side : {'c', 's', 'b'}) {  // also as what it is not
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
    // Small numbers are more often offsets that lead somewhere.
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
  const Message input = MakeInput(frames, 77, 0x8000000000000001U, nullptr, 12);
  EXPECT_LT(input.size(), 200U);
  ASSERT_EQ(ParseClientMessage(input, client), ParseResult::kOk);
  EXPECT_EQ(client->body_as_Input()->frames()->Get(0)->tick(), 104U);
  EXPECT_EQ(client->body_as_Input()->frames()->Get(0)->move_y(), -127);
  EXPECT_EQ(client->body_as_Input()->frames()->Get(1)->buttons(), 4);
  EXPECT_EQ(client->body_as_Input()->acked_sequence(), 77U);
  EXPECT_EQ(client->body_as_Input()->stalls(), 12U);
  EXPECT_EQ(client->body_as_Input()->acked_history(), 0x8000000000000001U);

  const wire::ServerMessage* server = nullptr;
  const Message welcome =
      MakeWelcome({7, 9, 1000, 60, 30, "arena", 2, {{wire::ObstacleKind::Box, {1, 2, 3}, {4, 5, 6}, 0}}});
  ASSERT_EQ(ParseServerMessage(welcome, server), ParseResult::kOk);
  EXPECT_EQ(server->body_as_Welcome()->scene()->str(), "arena");
  EXPECT_EQ(server->body_as_Welcome()->tick_hz(), 60);
  EXPECT_EQ(server->body_as_Welcome()->obstacles()->Get(0)->b().z(), 6.0F);
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 0, 0, 60, 30, "", 0, {}})), ParseResult::kOk) << "no obstacles at all";

  const wire::Blueprint* blueprint = nullptr;
  const Message triangle = MakeTriangle();
  ASSERT_EQ(ParseBlueprint(triangle, blueprint), ParseResult::kOk);
  EXPECT_EQ(blueprint->rest()->Get(3)->z(), -1.0F);
  EXPECT_EQ(blueprint->faces()->Get(2)->b(), 3);
}

template <class Body>
Message WrapClient(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Body> body) {
  builder.Finish(wire::CreateClientMessage(builder, wire::ClientBodyTraits<Body>::enum_value, body.Union()));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

template <class Body>
Message WrapServer(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Body> body) {
  builder.Finish(wire::CreateServerMessage(builder, wire::ServerBodyTraits<Body>::enum_value, body.Union()));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

ParseResult ParseHello(std::string_view name, std::uint8_t role) {
  flatbuffers::FlatBufferBuilder builder;
  const auto text = builder.CreateString(name.data(), name.size());
  return ParseAs('c', WrapClient(builder, wire::CreateHello(builder, 1, 2, text, static_cast<wire::Role>(role))));
}

TEST(Messages, HelloOutOfRange) {
  EXPECT_EQ(ParseHello(std::string(kMaxNameBytes, 'a'), 1), ParseResult::kOk);
  EXPECT_EQ(ParseHello("", 0), ParseResult::kOk);
  EXPECT_EQ(ParseHello(std::string(kMaxNameBytes + 1, 'a'), 1), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseHello("a", 2), ParseResult::kOutOfRange);
}

ParseResult ParseInput(const std::vector<wire::InputFrame>& frames) {
  flatbuffers::FlatBufferBuilder builder;
  const auto vector = builder.CreateVectorOfStructs(frames);
  return ParseAs('c', WrapClient(builder, wire::CreateInput(builder, vector, 1, 2)));
}

TEST(Messages, InputOutOfRange) {
  const wire::InputFrame good{1, 0, 0, 0};
  EXPECT_EQ(ParseInput(std::vector(kMaxInputFrames, good)), ParseResult::kOk);
  EXPECT_EQ(ParseInput(std::vector(kMaxInputFrames + 1, good)), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseInput({}), ParseResult::kMissingField);
  EXPECT_EQ(ParseInput({good, {1, -128, 0, 0}}), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseInput({good, {1, 0, -128, 0}}), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseInput({good, {1, 0, 0, 8}}), ParseResult::kOutOfRange);
}

TEST(Messages, WhatHandsDoOutOfRange) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<wire::InputFrame> frames{{1, 0, 0, 0}};
  const wire::Hand hand({1, kNan, 3}, 4, 5, 6);
  EXPECT_EQ(ParseAs('c', MakeInput(frames, 1, 1, &hand)), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakePush(1, 2, {kNan, 0, 0})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeCut(1, {}, {}, {0, 0, kNan})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeTune(static_cast<wire::TuneKind>(4), {})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeTune(wire::TuneKind::Gravity, {0, kNan, 0})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeBuild({.kind = static_cast<wire::BuildKind>(6)})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeBuild({.mass = kNan})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeBuild({.restLength = kNan})), ParseResult::kOutOfRange);
  flatbuffers::FlatBufferBuilder builder;
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreatePush(builder, 1, 2))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateBuild(builder))), ParseResult::kMissingField);
}

TEST(Messages, WhatTheServerTellsOutOfRange) {
  EXPECT_EQ(ParseAs('s', MakeTuning({.stiffness = 0})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeTuning({.timeRate = 1.5F})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeTuning({.may = 8})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeScoreboard({.phase = static_cast<wire::GamePhase>(2)})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeForces(1, 2, 0, {})), ParseResult::kOutOfRange) << "no stride";
  flatbuffers::FlatBufferBuilder builder;
  const auto values = builder.CreateVector(std::vector<std::int8_t>(4, 1));
  const auto sets = builder.CreateVector(std::vector{wire::CreateForceSet(builder, wire::ForceKind::Gas, 1, values)});
  const auto forces = wire::CreateForces(builder, 1, 2, 1, sets);
  EXPECT_EQ(ParseAs('s', WrapServer(builder, forces)), ParseResult::kOutOfRange) << "no whole vectors";
  EXPECT_EQ(ParseAs('s', MakeNotice(std::string(kMaxNoticeBytes, 'a'))), ParseResult::kOk);
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

TEST(Messages, TagsAreOneForEachOrNone) {
  const std::vector<Vector3> rest{{-1, 0, 0}, {1, 0, 0}};
  flatbuffers::FlatBufferBuilder builder;
  const auto parse = [&](std::size_t particles, std::size_t springs, float mass) {
    builder.Clear();
    const auto name = builder.CreateString("a");
    const auto restVector = builder.CreateVectorOfStructs(std::vector<wire::Vec3>(2));
    const auto faces = builder.CreateVectorOfStructs(std::vector<wire::Face>());
    const auto edges = builder.CreateVectorOfStructs(std::vector<wire::Edge>{{0, 1}});
    const auto tags = builder.CreateVectorOfStructs(std::vector<wire::ParticleTag>(particles, {mass, 0, 1, false}));
    const auto springTags = builder.CreateVectorOfStructs(std::vector<wire::SpringTag>(springs, {1, 1, 1, 0, 1}));
    builder.Finish(wire::CreateBlueprint(builder, name, restVector, faces, 1, edges, 0, tags, springTags));
    return ParseAs('b', Bytes(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()));
  };
  EXPECT_EQ(parse(2, 1, 1), ParseResult::kOk);
  EXPECT_EQ(parse(1, 1, 1), ParseResult::kOutOfRange);
  EXPECT_EQ(parse(2, 2, 1), ParseResult::kOutOfRange);
  EXPECT_EQ(parse(2, 1, std::numeric_limits<float>::infinity()), ParseResult::kOutOfRange);
}

TEST(Messages, GoodbyeAndEventOutOfRange) {
  const auto unknownReason = static_cast<wire::GoodbyeReason>(9);
  EXPECT_EQ(ParseAs('c', MakeClientGoodbye(unknownReason, "")), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeServerGoodbye(unknownReason, "")), ParseResult::kOutOfRange);
  const auto unknownEvent = static_cast<wire::EventKind>(5);
  EXPECT_EQ(ParseAs('s', MakeEvent(unknownEvent, 1, 2, 3, "")), ParseResult::kOutOfRange);
  const std::string longName(kMaxNameBytes + 1, 'a');
  EXPECT_EQ(ParseAs('s', MakeEvent(wire::EventKind::Join, 1, 2, 3, longName)), ParseResult::kOutOfRange);
}

TEST(Messages, WelcomeOutOfRange) {
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 0, 30, "a", 1, {}})), ParseResult::kOutOfRange) << "tick rate";
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 60, 0, "a", 1, {}})), ParseResult::kOutOfRange) << "snapshot rate";
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 60, 30, "a", 255, {}})), ParseResult::kOk);
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 60, 30, "a", 256, {}})), ParseResult::kOutOfRange) << "blueprints";
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 60, 30, "a", 1, {}, {}, 16})), ParseResult::kOutOfRange) << "hands";
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 60, 30, "a", 1, {}, {}, 1, -1})), ParseResult::kOutOfRange) << "reach";
  const auto unknown = static_cast<wire::ObstacleKind>(4);
  EXPECT_EQ(ParseAs('s', MakeWelcome({1, 2, 3, 60, 30, "a", 1, {{unknown, {}, {}, 1}}})), ParseResult::kOutOfRange);
}

TEST(Messages, ObstaclesOutOfRange) {
  const auto parse = [](const wire::Obstacle& obstacle) {
    return ParseAs('s', MakeWelcome({1, 2, 3, 60, 30, "a", 1, {obstacle}}));
  };
  using Shape = wire::ObstacleKind;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(parse({Shape::Sphere, {1, 2, 3}, {}, 0.5F}), ParseResult::kOk);
  EXPECT_EQ(parse({Shape::Sphere, {1, 2, 3}, {}, 0}), ParseResult::kOutOfRange) << "no radius";
  EXPECT_EQ(parse({Shape::Capsule, {1, 2, 3}, {}, -1}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Capsule, {1, 2, 3}, {}, kNan}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Plane, {1, kNan, 3}, {}, 0}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Box, {1, 2, 3}, {1, 1, kNan}, 0}), ParseResult::kOutOfRange);
  const wire::Obstacle plane{Shape::Plane, {0, 0, 1}, {}, 0};
  WelcomeFields many{1, 2, 3, 60, 30, "a", 1, std::vector(kMaxObstacles, plane)};
  EXPECT_EQ(ParseAs('s', MakeWelcome(many)), ParseResult::kOk);
  many.obstacles.push_back(plane);
  EXPECT_EQ(ParseAs('s', MakeWelcome(many)), ParseResult::kOutOfRange);
}

TEST(Messages, HeightFieldsOutOfRange) {
  const auto parse = [](const std::vector<wire::HeightField>& fields) {
    WelcomeFields welcome{1, 2, 3, 60, 30, "a", 1, {}};
    welcome.heightFields = fields;
    return ParseAs('s', MakeWelcome(welcome));
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const wire::HeightField good{{0, 0, 1}, 1, -1, 0.1F, 128, 2};
  EXPECT_EQ(parse(std::vector(kMaxHeightFields, good)), ParseResult::kOk);
  EXPECT_EQ(parse(std::vector(kMaxHeightFields + 1, good)), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({{{0, 0, 1}, 1, -1, 0.1F, 129, 2}}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({{{0, 0, 1}, 1, -1, 0.1F, 2, 1}}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({{{kNan, 0, 1}, 1, -1, 0.1F, 2, 2}}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({{{0, 0, 1}, 0, -1, 0.1F, 2, 2}}), ParseResult::kOutOfRange) << "no cell";
  EXPECT_EQ(parse({{{0, 0, 1}, 3e38F, -1, 0.1F, 2, 2}}), ParseResult::kOutOfRange) << "ends in infinity";
  EXPECT_EQ(parse({{{0, 0, 1}, 1, -1, -0.1F, 2, 2}}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({{{0, 0, 1}, 1, -1, 1e35F, 2, 2}}), ParseResult::kOutOfRange) << "as high as infinity";

  const auto rows = [](std::uint16_t field, std::uint16_t first, std::size_t count) {
    flatbuffers::FlatBufferBuilder builder;
    const auto vector = builder.CreateVector(std::vector<std::uint16_t>(count, 3));
    return ParseAs('s', WrapServer(builder, wire::CreateHeightRows(builder, field, first, vector)));
  };
  EXPECT_EQ(rows(15, 127, kMaxRowsHeights), ParseResult::kOk);
  EXPECT_EQ(rows(16, 0, 2), ParseResult::kOutOfRange);
  EXPECT_EQ(rows(0, 128, 2), ParseResult::kOutOfRange);
  EXPECT_EQ(rows(0, 0, kMaxRowsHeights + 1), ParseResult::kOutOfRange);
  EXPECT_EQ(rows(0, 0, 0), ParseResult::kMissingField);
}

TEST(Messages, EdgesAndGenerationsOutOfRange) {
  const std::vector<Vector3> rest{{-1, 0, 0}, {1, 0, 0}};
  const auto parse = [&](const std::vector<std::array<std::uint16_t, 2>>& edges) {
    return ParseAs('b', MakeBlueprint({.name = "pair", .rest = rest, .edges = edges}));
  };
  EXPECT_EQ(parse({{0, 1}}), ParseResult::kOk);
  EXPECT_EQ(parse({}), ParseResult::kOk) << "none";
  EXPECT_EQ(parse({{0, 2}}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse(std::vector<std::array<std::uint16_t, 2>>(kMaxBlueprintEdges, {0, 1})), ParseResult::kOk);
  flatbuffers::FlatBufferBuilder builder;
  const auto vector = builder.CreateVector(Bytes(4, 1));
  const auto chunk = wire::CreateBlueprintChunk(builder, 0, 1, 4, 0, vector, kGenerations);
  EXPECT_EQ(ParseAs('s', WrapServer(builder, chunk)), ParseResult::kOutOfRange);
}

ParseResult ParseChunk(std::uint32_t total, std::uint32_t offset, std::size_t length) {
  flatbuffers::FlatBufferBuilder builder;
  const auto vector = builder.CreateVector(Bytes(length, 1));
  return ParseAs('s', WrapServer(builder, wire::CreateBlueprintChunk(builder, 0, 1, total, offset, vector)));
}

TEST(Messages, ChunkOutOfRange) {
  EXPECT_EQ(ParseChunk(100, 90, 10), ParseResult::kOk);
  EXPECT_EQ(ParseChunk(kMaxBlueprintBytes, 0, kBlueprintChunkBytes), ParseResult::kOk);
  EXPECT_EQ(ParseChunk(100, 90, 0), ParseResult::kMissingField);
  EXPECT_EQ(ParseChunk(100, 91, 10), ParseResult::kOutOfRange) << "runs past the whole";
  EXPECT_EQ(ParseChunk(100, 0xFFFFFFFF, 10), ParseResult::kOutOfRange) << "offset + size wraps";
  EXPECT_EQ(ParseChunk(kMaxBlueprintBytes + 1, 0, 10), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseChunk(kMaxBlueprintBytes, 0, kBlueprintChunkBytes + 1), ParseResult::kOutOfRange);
}

TEST(Messages, BlueprintOutOfRange) {
  using Faces = std::vector<std::array<std::uint16_t, 3>>;
  const std::vector<Vector3> rest(4);
  EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = rest})), ParseResult::kOk);
  for (const Faces& faces : {Faces{{4, 0, 1}}, Faces{{0, 4, 1}}, Faces{{0, 1, 2}, {0, 1, 65535}}}) {
    EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = rest, .faces = faces})), ParseResult::kOutOfRange);
  }
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float size : {0.0F, -1.0F, kInfinity, kNan}) {
    EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = rest, .size = size})), ParseResult::kOutOfRange) << size;
  }
  for (const Vector3 bad : {Vector3{kNan, 0, 0}, Vector3{0, -kInfinity, 0}, Vector3{0, 0, kNan}}) {
    EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = std::vector{Vector3{}, bad}})),
              ParseResult::kOutOfRange);
  }
  EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = {}})), ParseResult::kMissingField);
  EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = std::vector<Vector3>(kMaxBodyVertices)})),
            ParseResult::kOk);
  EXPECT_EQ(ParseAs('b', MakeBlueprint({.name = "a", .rest = std::vector<Vector3>(kMaxBodyVertices + 1)})),
            ParseResult::kOutOfRange);
}

TEST(Messages, AbsentPartsAreMissing) {
  flatbuffers::FlatBufferBuilder builder;
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateHello(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateInput(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateGoodbye(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('s', WrapServer(builder, wire::CreateWelcome(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('s', WrapServer(builder, wire::CreateBlueprintChunk(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('s', WrapServer(builder, wire::CreateEvent(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('s', WrapServer(builder, wire::CreateGoodbye(builder))), ParseResult::kMissingField);
  builder.Clear();
  builder.Finish(wire::CreateClientMessage(builder));
  const Bytes empty(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
  EXPECT_EQ(ParseAs('c', empty), ParseResult::kMissingField);
}

// A union of a type that only a later version has: FlatBuffers lets it through, we do not.
TEST(Messages, AnUnknownKindIsOutOfRange) {
  flatbuffers::FlatBufferBuilder builder;
  const auto body = wire::CreateGoodbye(builder, wire::GoodbyeReason::Left, builder.CreateString("x"));
  builder.Finish(wire::CreateClientMessage(builder, static_cast<wire::ClientBody>(13), body.Union()));
  const Bytes bytes(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
  EXPECT_EQ(ParseAs('c', bytes), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', bytes), ParseResult::kOutOfRange);
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
