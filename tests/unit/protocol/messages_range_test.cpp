// Fields out of their ranges, and fields that are not there: each is refused with its reason.
#include <gtest/gtest.h>

#include <limits>

#include "protocol/messages.h"
#include "tests/unit/damage.h"
#include "tests/unit/protocol/parse_messages.h"

namespace wobble::protocol {
namespace {

using parsing::ParseAs;
using test::Bytes;

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
  EXPECT_EQ(ParseAs('c', MakeInput({.frames = frames, .ackedSequence = 1, .ackedHistory = 1, .hand = &hand})),
            ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakePush(1, 2, {kNan, 0, 0})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeCut(1, {}, {}, {0, 0, kNan})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeOrder(std::string(kMaxOrderBytes, 'a'))), ParseResult::kOk);
  EXPECT_EQ(ParseAs('c', MakeOrder(std::string(kMaxOrderBytes + 1, 'a'))), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeSay(std::string(kMaxSaidBytes, 'a'))), ParseResult::kOk);
  EXPECT_EQ(ParseAs('c', MakeSay(std::string(kMaxSaidBytes + 1, 'a'))), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeRename(std::string(kMaxNameBytes, 'a'))), ParseResult::kOk);
  EXPECT_EQ(ParseAs('c', MakeRename(std::string(kMaxNameBytes + 1, 'a'))), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeEmote(static_cast<wire::EmoteKind>(6))), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeTune(static_cast<wire::TuneKind>(4), {})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeTune(wire::TuneKind::Gravity, {0, kNan, 0})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeBuild({.kind = static_cast<wire::BuildKind>(6)})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeBuild({.mass = kNan})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('c', MakeBuild({.restLength = kNan})), ParseResult::kOutOfRange);
  flatbuffers::FlatBufferBuilder builder;
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreatePush(builder, 1, 2))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateBuild(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateSay(builder))), ParseResult::kMissingField);
  builder.Clear();
  EXPECT_EQ(ParseAs('c', WrapClient(builder, wire::CreateRename(builder))), ParseResult::kMissingField);
}

TEST(Messages, WhatTheServerTellsOutOfRange) {
  EXPECT_EQ(ParseAs('s', MakeTuning({.stiffness = 0})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeTuning({.timeRate = 1.5F})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeTuning({.may = 8})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeScoreboard({.phase = static_cast<wire::GamePhase>(6)})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeScoreboard({.winningSide = 3})), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeScoreboard({.sides = {{1, 0}}})), ParseResult::kOutOfRange) << "one side";
  EXPECT_EQ(ParseAs('s', MakeScoreboard({.scores = {{7, 3, 1}}, .seats = {{3, true, false}}})),
            ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeForces(1, 2, 0, {})), ParseResult::kOutOfRange) << "no stride";
  flatbuffers::FlatBufferBuilder builder;
  const auto values = builder.CreateVector(std::vector<std::int8_t>(4, 1));
  const auto sets = builder.CreateVector(std::vector{wire::CreateForceSet(builder, wire::ForceKind::Gas, 1, values)});
  const auto forces = wire::CreateForces(builder, 1, 2, 1, sets);
  EXPECT_EQ(ParseAs('s', WrapServer(builder, forces)), ParseResult::kOutOfRange) << "no whole vectors";
  EXPECT_EQ(ParseAs('s', MakeNotice(std::string(kMaxNoticeBytes, 'a'))), ParseResult::kOk);
  using Kind = wire::EventKind;
  const auto parse = [](Kind kind, std::size_t bytes, wire::EmoteKind emote = {}) {
    return ParseAs('s', MakeEvent(kind, 1, 2, 3, std::string(bytes, 'a'), emote));
  };
  EXPECT_EQ(parse(Kind::Said, kMaxSaidBytes), ParseResult::kOk);
  EXPECT_EQ(parse(Kind::Said, kMaxSaidBytes + 1), ParseResult::kOutOfRange);
  EXPECT_EQ(parse(Kind::Rename, kMaxNameBytes + 1), ParseResult::kOutOfRange);
  EXPECT_EQ(parse(static_cast<Kind>(10), 0), ParseResult::kOutOfRange);
  EXPECT_EQ(parse(Kind::Emote, 0, static_cast<wire::EmoteKind>(6)), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeWelcome({.tickHz = 60, .snapshotHz = 30, .scene = "", .obstacles = {}, .talk = 4})),
            ParseResult::kOutOfRange);
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
  const auto unknownReason = static_cast<wire::GoodbyeReason>(14);
  EXPECT_EQ(ParseAs('c', MakeClientGoodbye(unknownReason, "")), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', MakeServerGoodbye(unknownReason, "")), ParseResult::kOutOfRange);
  const auto unknownEvent = static_cast<wire::EventKind>(10);
  EXPECT_EQ(ParseAs('s', MakeEvent(unknownEvent, 1, 2, 3, "")), ParseResult::kOutOfRange);
  const std::string longName(kMaxNameBytes + 1, 'a');
  EXPECT_EQ(ParseAs('s', MakeEvent(wire::EventKind::Join, 1, 2, 3, longName)), ParseResult::kOutOfRange);
}

WelcomeFields MakeGoodWelcome() {
  return {.clientId = 1,
          .ownBody = 2,
          .tick = 3,
          .tickHz = 60,
          .snapshotHz = 30,
          .scene = "a",
          .blueprintCount = 1,
          .obstacles = {}};
}

TEST(Messages, WelcomeOutOfRange) {
  const auto parse = [](const auto& change) {
    WelcomeFields fields = MakeGoodWelcome();
    change(fields);
    return ParseAs('s', MakeWelcome(fields));
  };
  using Fields = WelcomeFields;
  EXPECT_EQ(parse([](Fields& f) { f.tickHz = 0; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.snapshotHz = 0; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.blueprintCount = 255; }), ParseResult::kOk);
  EXPECT_EQ(parse([](Fields& f) { f.blueprintCount = 256; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.hands = 16; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.hands = 1, f.reach = -1; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.drive = {25, 6, 0}; }), ParseResult::kOk);
  EXPECT_EQ(parse([](Fields& f) { f.drive = {-1, 6, 0}; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.drive = {25, 8193, 0}; }), ParseResult::kOutOfRange);
  EXPECT_EQ(parse([](Fields& f) { f.drive = {25, 6, std::nanf("")}; }), ParseResult::kOutOfRange);
  const auto unknown = static_cast<wire::ObstacleKind>(4);
  EXPECT_EQ(parse([&](Fields& f) { f.obstacles = {{unknown, {}, {}, 1}}; }), ParseResult::kOutOfRange);
}

TEST(Messages, ObstaclesOutOfRange) {
  const auto parse = [](const wire::Obstacle& obstacle) {
    WelcomeFields welcome = MakeGoodWelcome();
    welcome.obstacles = {obstacle};
    return ParseAs('s', MakeWelcome(welcome));
  };
  using Shape = wire::ObstacleKind;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(parse({Shape::Sphere, {1, 2, 3}, {}, 0.5F}), ParseResult::kOk);
  EXPECT_EQ(parse({Shape::Sphere, {1, 2, 3}, {}, 0}), ParseResult::kOutOfRange) << "no radius";
  EXPECT_EQ(parse({Shape::Capsule, {1, 2, 3}, {}, -1}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Capsule, {1, 2, 3}, {}, kNan}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Plane, {1, kNan, 3}, {}, 0}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Box, {1, 2, 3}, {1, 1, kNan}, 0}), ParseResult::kOutOfRange);
  EXPECT_EQ(parse({Shape::Box, {1, 2, 3}, {1, -1, 1}, 0}), ParseResult::kOutOfRange);
  for (const float length : {0.0F, 0.99F, 1.01F, -2.0F, 1e30F, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(parse({Shape::Plane, {0, 0, length}, {}, 0}), ParseResult::kOutOfRange) << length;
  }
  EXPECT_EQ(parse({Shape::Plane, {0.6F, 0, 0.8F}, {8192, 0, 0}, 0}), ParseResult::kOk);
  EXPECT_EQ(parse({Shape::Plane, {0, -0.9995F, 0}, {-8192, 0, 0}, 0}), ParseResult::kOk);
  // Every number of every kind, too large by little and by much.
  for (const float large : {8193.0F, -8193.0F, 1e30F, -3e38F}) {
    EXPECT_EQ(parse({Shape::Plane, {0, 0, 1}, {large, 0, 0}, 0}), ParseResult::kOutOfRange);
    for (const Shape shape : {Shape::Box, Shape::Sphere, Shape::Capsule}) {
      EXPECT_EQ(parse({shape, {1, 2, 3}, {1, 1, 1}, 1}), ParseResult::kOk);
      EXPECT_EQ(parse({shape, {large, 2, 3}, {1, 1, 1}, 1}), ParseResult::kOutOfRange);
      EXPECT_EQ(parse({shape, {1, 2, large}, {1, 1, 1}, 1}), ParseResult::kOutOfRange);
      EXPECT_EQ(parse({shape, {1, 2, 3}, {1, large, 1}, 1}), ParseResult::kOutOfRange);
      EXPECT_EQ(parse({shape, {1, 2, 3}, {1, 1, 1}, large}), ParseResult::kOutOfRange);
    }
  }
  const wire::Obstacle plane{Shape::Plane, {0, 0, 1}, {}, 0};
  WelcomeFields many = MakeGoodWelcome();
  many.obstacles.assign(kMaxObstacles, plane);
  EXPECT_EQ(ParseAs('s', MakeWelcome(many)), ParseResult::kOk);
  many.obstacles.push_back(plane);
  EXPECT_EQ(ParseAs('s', MakeWelcome(many)), ParseResult::kOutOfRange);
}

TEST(Messages, HeightFieldsOutOfRange) {
  const auto parse = [](const std::vector<wire::HeightField>& fields) {
    WelcomeFields welcome = MakeGoodWelcome();
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
  EXPECT_EQ(parse({{{0, 0, 1}, 1, -1, 0.2F, 2, 2}}), ParseResult::kOutOfRange) << "higher than the world";
  EXPECT_EQ(parse({{{0, 9000, 1}, 1, -1, 0.1F, 2, 2}}), ParseResult::kOutOfRange) << "begins outside of it";
  EXPECT_EQ(parse({{{0, 0, 1}, 9000, -1, 0.1F, 2, 2}}), ParseResult::kOutOfRange) << "a cell larger than it";
  EXPECT_EQ(parse({{{0, 0, -8000}, 1, -8000, 0.1F, 2, 2}}), ParseResult::kOutOfRange) << "deeper than it";
  EXPECT_EQ(parse({{{0, 0, 1}, 1, kNan, 0.1F, 2, 2}}), ParseResult::kOutOfRange);

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
  for (const float size : {0.0F, -1.0F, 1e-40F, 0.0009F, kInfinity, kNan}) {
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

// A union of a type that only a later version has: FlatBuffers accepts it, the parsers refuse it.
TEST(Messages, AnUnknownKindIsOutOfRange) {
  flatbuffers::FlatBufferBuilder builder;
  const auto body = wire::CreateGoodbye(builder, wire::GoodbyeReason::Left, builder.CreateString("x"));
  builder.Finish(wire::CreateClientMessage(builder, static_cast<wire::ClientBody>(13), body.Union()));
  const Bytes bytes(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
  EXPECT_EQ(ParseAs('c', bytes), ParseResult::kOutOfRange);
  EXPECT_EQ(ParseAs('s', bytes), ParseResult::kOutOfRange);
}

}  // namespace
}  // namespace wobble::protocol
