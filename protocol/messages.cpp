#include "protocol/messages.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::protocol {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

Message Take(const FlatBufferBuilder& builder) {
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

template <class Body>
Message FinishClientMessage(FlatBufferBuilder& builder, Offset<Body> body) {
  builder.Finish(wire::CreateClientMessage(builder, wire::ClientBodyTraits<Body>::enum_value, body.Union()));
  assert(builder.GetSize() <= kMaxClientMessageBytes);
  return Take(builder);
}

template <class Body>
Message FinishServerMessage(FlatBufferBuilder& builder, Offset<Body> body) {
  builder.Finish(wire::CreateServerMessage(builder, wire::ServerBodyTraits<Body>::enum_value, body.Union()));
  assert(builder.GetSize() <= kMaxServerMessageBytes);
  return Take(builder);
}

wire::Vec3 ToWire(Vector3 v) { return {v.x, v.y, v.z}; }

}  // namespace

Message MakeHello(std::string_view name, wire::Role role, std::span<const std::uint64_t> kept, std::uint16_t version,
                  std::uint64_t schemaHash, bool isBot) {
  assert(name.size() <= kMaxNameBytes && kept.size() <= kMaxKeptBlueprints);
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(name.data(), name.size());
  const auto hashes = builder.CreateVector(kept.data(), kept.size());
  return FinishClientMessage(builder, wire::CreateHello(builder, version, schemaHash, text, role, hashes, isBot));
}

Message MakeInput(const InputFields& fields) {
  assert(!fields.frames.empty() && fields.frames.size() <= kMaxInputFrames);
  FlatBufferBuilder builder;
  const auto frames = builder.CreateVectorOfStructs(fields.frames.data(), fields.frames.size());
  return FinishClientMessage(builder, wire::CreateInput(builder, frames, fields.ackedSequence, fields.ackedHistory,
                                                        fields.hand, fields.stalls, fields.downloaded));
}

Message MakeClientGoodbye(wire::GoodbyeReason reason, std::string_view detail) {
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(detail.data(), detail.size());
  return FinishClientMessage(builder, wire::CreateGoodbye(builder, reason, text));
}

Message MakePush(std::uint32_t body, std::uint16_t vertex, const Vector3& direction) {
  FlatBufferBuilder builder;
  const wire::Vec3 along = ToWire(direction);
  return FinishClientMessage(builder, wire::CreatePush(builder, body, vertex, &along));
}

Message MakeCut(std::uint32_t body, const Vector3& eye, const Vector3& from, const Vector3& to) {
  FlatBufferBuilder builder;
  const wire::Vec3 corners[] = {ToWire(eye), ToWire(from), ToWire(to)};
  return FinishClientMessage(builder, wire::CreateCut(builder, body, &corners[0], &corners[1], &corners[2]));
}

Message MakeInspect(std::uint32_t body) {
  FlatBufferBuilder builder;
  return FinishClientMessage(builder, wire::CreateInspect(builder, body));
}

Message MakeTune(wire::TuneKind kind, const Vector3& value) {
  FlatBufferBuilder builder;
  const wire::Vec3 wireValue = ToWire(value);
  return FinishClientMessage(builder, wire::CreateTune(builder, kind, &wireValue));
}

Message MakeBuild(const BuildFields& fields) {
  FlatBufferBuilder builder;
  const wire::Vec3 at = ToWire(fields.at);
  return FinishClientMessage(builder,
                             wire::CreateBuild(builder, fields.kind, fields.a, fields.b, &at, fields.mass, fields.fixed,
                                               fields.stiffness, fields.damping, fields.restLength));
}

Message MakeOrder(std::string_view line) {
  FlatBufferBuilder builder;
  return FinishClientMessage(builder, wire::CreateOrder(builder, builder.CreateString(line)));
}

Message MakeSay(std::string_view text) {
  FlatBufferBuilder builder;
  return FinishClientMessage(builder, wire::CreateSay(builder, builder.CreateString(text)));
}

Message MakeEmote(wire::EmoteKind kind) {
  FlatBufferBuilder builder;
  return FinishClientMessage(builder, wire::CreateEmote(builder, kind));
}

Message MakeRename(std::string_view name) {
  FlatBufferBuilder builder;
  return FinishClientMessage(builder, wire::CreateRename(builder, builder.CreateString(name)));
}

Message MakeWelcome(const WelcomeFields& fields) {
  assert(fields.description.size() <= kMaxDescriptionBytes);
  FlatBufferBuilder builder;
  const auto scene = builder.CreateString(fields.scene);
  const auto obstacles = builder.CreateVectorOfStructs(fields.obstacles);
  const auto heightFields = builder.CreateVectorOfStructs(fields.heightFields);
  const auto game = builder.CreateString(fields.game);
  const auto description =
      fields.description.empty() ? Offset<flatbuffers::String>() : builder.CreateString(fields.description);
  return FinishServerMessage(
      builder, wire::CreateWelcome(builder, fields.clientId, fields.ownBody, fields.tick, fields.tickHz,
                                   fields.snapshotHz, scene, fields.blueprintCount, obstacles, heightFields,
                                   fields.hands, fields.reach, game, fields.workshop, fields.ownBlueprint, fields.rank,
                                   fields.drive.speed() > 0 ? &fields.drive : nullptr, description, fields.talk));
}

Message MakeBlueprintChunk(std::uint8_t blueprint, std::uint64_t hash, std::uint32_t total, std::uint32_t offset,
                           std::span<const std::uint8_t> bytes, std::uint8_t generation) {
  assert(bytes.size() <= kBlueprintChunkBytes && generation < kGenerations);
  FlatBufferBuilder builder;
  const auto vector = builder.CreateVector(bytes.data(), bytes.size());
  return FinishServerMessage(builder,
                             wire::CreateBlueprintChunk(builder, blueprint, hash, total, offset, vector, generation));
}

Message MakeHeightRows(std::uint16_t field, std::uint16_t firstRow, std::span<const std::uint16_t> heights) {
  assert(!heights.empty() && heights.size() <= kMaxRowsHeights);
  FlatBufferBuilder builder;
  const auto vector = builder.CreateVector(heights.data(), heights.size());
  return FinishServerMessage(builder, wire::CreateHeightRows(builder, field, firstRow, vector));
}

Message MakeEvent(wire::EventKind kind, std::uint32_t tick, std::uint32_t clientId, std::uint32_t body,
                  std::string_view name, wire::EmoteKind emote) {
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(name.data(), name.size());
  return FinishServerMessage(builder, wire::CreateEvent(builder, kind, tick, clientId, body, text, emote));
}

Message MakeServerGoodbye(wire::GoodbyeReason reason, std::string_view detail) {
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(detail.data(), detail.size());
  return FinishServerMessage(builder, wire::CreateGoodbye(builder, reason, text));
}

Message MakeTuning(const TuningFields& fields) {
  FlatBufferBuilder builder;
  const wire::Vec3 gravity = ToWire(fields.gravity);
  return FinishServerMessage(builder,
                             wire::CreateTuning(builder, &gravity, fields.stiffness, fields.timeRate, fields.may));
}

namespace {

float FindLargest(std::span<const Vector3> values) {
  float largest = 0;
  for (const Vector3& v : values) largest = std::max({largest, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return largest;
}

}  // namespace

Message MakeForces(std::uint32_t body, std::uint32_t tick, std::uint16_t stride, std::span<const ForceField> fields) {
  FlatBufferBuilder builder;
  std::vector<Offset<wire::ForceSet>> sets;
  for (const ForceField& field : fields) {
    assert(field.values.size() <= kMaxShownForces);
    const float scale = FindLargest(field.values);
    if (!(scale > 0)) continue;
    std::vector<std::int8_t> steps;
    for (const Vector3& v : field.values) {
      for (const float value : {v.x, v.y, v.z}) {
        steps.push_back(static_cast<std::int8_t>(std::lround(value / scale * kForceSteps)));
      }
    }
    const auto values = builder.CreateVector(steps);
    sets.push_back(wire::CreateForceSet(builder, field.kind, scale, values));
  }
  const auto vector = builder.CreateVector(sets);
  return FinishServerMessage(builder, wire::CreateForces(builder, body, tick, stride, vector));
}

namespace {

// Leaves an empty vector out: the field is then absent.
template <class Struct>
Offset<flatbuffers::Vector<const Struct*>> CreateUnlessEmpty(FlatBufferBuilder& builder, std::span<const Struct> list) {
  return list.empty() ? Offset<flatbuffers::Vector<const Struct*>>()
                      : builder.CreateVectorOfStructs(list.data(), list.size());
}

}  // namespace

Message MakeScoreboard(const ScoreboardFields& fields) {
  assert(fields.scores.size() <= kMaxScores);
  assert(fields.seats.empty() || fields.seats.size() == fields.scores.size());
  FlatBufferBuilder builder;
  const auto scores = builder.CreateVectorOfStructs(fields.scores);
  const auto seats = CreateUnlessEmpty<wire::Seat>(builder, fields.seats);
  const auto sides = CreateUnlessEmpty<wire::SideScore>(builder, fields.sides);
  return FinishServerMessage(
      builder,
      wire::CreateScoreboard(builder, fields.phase, fields.round, fields.secondsLeft, fields.pointsToWin, fields.winner,
                             scores, fields.rounds, seats, sides, fields.winningSide, fields.object, fields.bearer));
}

Message MakeNotice(std::string_view text) {
  assert(text.size() <= kMaxNoticeBytes);
  FlatBufferBuilder builder;
  const auto line = builder.CreateString(text.data(), text.size());
  return FinishServerMessage(builder, wire::CreateNotice(builder, line));
}

Message MakeNextScene(std::string_view scene) {
  FlatBufferBuilder builder;
  const auto name = builder.CreateString(scene.data(), scene.size());
  return FinishServerMessage(builder, wire::CreateNextScene(builder, name));
}

namespace {

Offset<flatbuffers::Vector<Offset<wire::Basis>>> CreateBases(FlatBufferBuilder& builder,
                                                             std::span<const std::vector<std::uint8_t>> bases) {
  if (bases.empty()) return {};
  std::vector<Offset<wire::Basis>> wireBases;
  for (const std::vector<std::uint8_t>& basis : bases) {
    wireBases.push_back(wire::CreateBasis(builder, builder.CreateVector(basis)));
  }
  return builder.CreateVector(wireBases);
}

}  // namespace

Message MakeBlueprint(const BlueprintFields& fields) {
  assert(fields.edges.size() <= kMaxBlueprintEdges);
  assert(fields.particles.empty() || fields.particles.size() == fields.rest.size());
  assert(fields.springs.empty() || fields.springs.size() == fields.edges.size());
  FlatBufferBuilder builder;
  std::vector<wire::Vec3> rest(fields.rest.size());
  std::transform(fields.rest.begin(), fields.rest.end(), rest.begin(), ToWire);
  std::vector<wire::Face> faces;
  faces.reserve(fields.faces.size());
  for (const auto& face : fields.faces) faces.emplace_back(face[0], face[1], face[2]);
  std::vector<wire::Edge> edges;
  edges.reserve(fields.edges.size());
  for (const auto& edge : fields.edges) edges.emplace_back(edge[0], edge[1]);

  const auto name = builder.CreateString(fields.name.data(), fields.name.size());
  const auto restVector = builder.CreateVectorOfStructs(rest);
  const auto faceVector = builder.CreateVectorOfStructs(faces);
  const auto edgeVector = CreateUnlessEmpty<wire::Edge>(builder, edges);
  const auto bases = CreateBases(builder, fields.bases);
  const auto particles = CreateUnlessEmpty(builder, fields.particles);
  const auto springs = CreateUnlessEmpty(builder, fields.springs);
  builder.Finish(
      wire::CreateBlueprint(builder, name, restVector, faceVector, fields.size, edgeVector, bases, particles, springs));
  assert(builder.GetSize() <= kMaxBlueprintBytes);
  return Take(builder);
}

std::uint64_t HashBytes(std::span<const std::uint8_t> bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3U;
  return hash;
}

const char* Name(ParseResult result) {
  switch (result) {
    case ParseResult::kOk:
      return "ok";
    case ParseResult::kTooLarge:
      return "too large";
    case ParseResult::kMalformed:
      return "malformed";
    case ParseResult::kMissingField:
      return "missing field";
    case ParseResult::kOutOfRange:
      return "out of range";
  }
  return "unknown";
}

const char* Name(wire::GoodbyeReason reason) {
  switch (reason) {
    case wire::GoodbyeReason::Left:
      return "left";
    case wire::GoodbyeReason::ServerClosing:
      return "server is closing";
    case wire::GoodbyeReason::ServerFull:
      return "server is full";
    case wire::GoodbyeReason::WrongVersion:
      return "wrong protocol version";
    case wire::GoodbyeReason::WrongSchema:
      return "wrong schema";
    case wire::GoodbyeReason::NoHello:
      return "no hello in time";
    case wire::GoodbyeReason::Silent:
      return "silent for too long";
    case wire::GoodbyeReason::BadMessages:
      return "too many bad messages";
    case wire::GoodbyeReason::Busy:
      return "server is busy";
    case wire::GoodbyeReason::TooMuch:
      return "sent too much, or took too little";
    case wire::GoodbyeReason::Kicked:
      return "removed by a moderator";
    case wire::GoodbyeReason::Banned:
      return "banned from this server";
    case wire::GoodbyeReason::BadToken:
      return "the password, invite or token is missing or not valid, or too many were tried from your address: wait "
             "5 s";
    case wire::GoodbyeReason::TooManyFromAddress:
      return "too many connections from this address";
  }
  return "unknown reason";
}

std::string DescribeGoodbye(wire::GoodbyeReason reason, std::string_view detail) {
  const bool isLocked = reason == wire::GoodbyeReason::ServerFull && detail == kLockedDetail;
  if (isLocked) return std::string(detail);
  return Name(reason) + (detail.empty() ? "" : ": " + std::string(detail));
}

}  // namespace wobble::protocol
