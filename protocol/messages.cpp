#include "protocol/messages.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::protocol {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

template <class Root>
const Root* VerifyRoot(std::span<const std::uint8_t> bytes, std::uint32_t maxTables = kMaxMessageTables) {
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxMessageDepth, maxTables);
  return verifier.VerifyBuffer<Root>(nullptr) ? flatbuffers::GetRoot<Root>(bytes.data()) : nullptr;
}

// FlatBuffers reads numbers where they lie: its verifier wants the alignment that a network buffer need not have.
// Every transport hands out buffers from the allocator or ENet's packets, both aligned to 8; a caller with another
// buffer gets kMalformed, not undefined behaviour.
bool IsAligned(std::span<const std::uint8_t> bytes) {
  return reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::uint64_t) == 0;
}

template <class Enum>
bool IsKnown(Enum value, Enum last) {
  return static_cast<std::uint8_t>(value) <= static_cast<std::uint8_t>(last);
}

ParseResult CheckGoodbye(const wire::Goodbye& goodbye) {
  if (goodbye.detail() == nullptr) return ParseResult::kMissingField;
  return IsKnown(goodbye.reason(), wire::GoodbyeReason::MAX) ? ParseResult::kOk : ParseResult::kOutOfRange;
}

ParseResult CheckHello(const wire::Hello& hello) {
  if (hello.name() == nullptr) return ParseResult::kMissingField;
  if (hello.name()->size() > kMaxNameBytes || !IsKnown(hello.role(), wire::Role::MAX)) return ParseResult::kOutOfRange;
  return ParseResult::kOk;
}

ParseResult CheckInput(const wire::Input& input) {
  if (input.frames() == nullptr || input.frames()->size() == 0) return ParseResult::kMissingField;
  if (input.frames()->size() > kMaxInputFrames) return ParseResult::kOutOfRange;
  for (const wire::InputFrame* frame : *input.frames()) {
    if (frame->buttons() > 7 || frame->move_x() == -128 || frame->move_y() == -128) return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

bool IsFinite(const wire::Vec3& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

bool IsGood(const wire::Obstacle& obstacle) {
  const bool isRound = obstacle.kind() == wire::ObstacleKind::Sphere || obstacle.kind() == wire::ObstacleKind::Capsule;
  return IsKnown(obstacle.kind(), wire::ObstacleKind::MAX) && IsFinite(obstacle.a()) && IsFinite(obstacle.b()) &&
         std::isfinite(obstacle.radius()) && (!isRound || obstacle.radius() > 0.0F);
}

bool IsGood(const wire::HeightField& field) {
  const auto fits = [](std::uint16_t nodes) { return nodes >= 2 && nodes <= kMaxFieldNodes; };
  return fits(field.columns()) && fits(field.rows()) && IsFinite(field.corner()) && field.cell_size() > 0.0F &&
         std::isfinite(field.cell_size() * static_cast<float>(kMaxFieldNodes)) && std::isfinite(field.low()) &&
         field.step() >= 0.0F && std::isfinite(field.corner().z() + field.low() + field.step() * 65535.0F);
}

ParseResult CheckWelcome(const wire::Welcome& welcome) {
  if (welcome.scene() == nullptr || welcome.obstacles() == nullptr || welcome.height_fields() == nullptr) {
    return ParseResult::kMissingField;
  }
  if (welcome.tick_hz() == 0 || welcome.snapshot_hz() == 0 || welcome.blueprint_count() > kMaxBlueprints ||
      welcome.obstacles()->size() > kMaxObstacles || welcome.height_fields()->size() > kMaxHeightFields) {
    return ParseResult::kOutOfRange;
  }
  for (const wire::Obstacle* obstacle : *welcome.obstacles()) {
    if (!IsGood(*obstacle)) return ParseResult::kOutOfRange;
  }
  for (const wire::HeightField* field : *welcome.height_fields()) {
    if (!IsGood(*field)) return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

ParseResult CheckRows(const wire::HeightRows& rows) {
  if (rows.heights() == nullptr || rows.heights()->size() == 0) return ParseResult::kMissingField;
  const bool fits =
      rows.heights()->size() <= kMaxRowsHeights && rows.field() < kMaxHeightFields && rows.first_row() < kMaxFieldNodes;
  return fits ? ParseResult::kOk : ParseResult::kOutOfRange;
}

ParseResult CheckChunk(const wire::BlueprintChunk& chunk) {
  if (chunk.bytes() == nullptr || chunk.bytes()->size() == 0) return ParseResult::kMissingField;
  if (chunk.generation() >= kGenerations || chunk.total() > kMaxBlueprintBytes ||
      chunk.bytes()->size() > kBlueprintChunkBytes || chunk.offset() > chunk.total() ||
      chunk.bytes()->size() > chunk.total() - chunk.offset()) {
    return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

ParseResult CheckEvent(const wire::Event& event) {
  if (event.name() == nullptr) return ParseResult::kMissingField;
  if (event.name()->size() > kMaxNameBytes || !IsKnown(event.kind(), wire::EventKind::MAX)) {
    return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

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

ParseResult ParseClientMessage(std::span<const std::uint8_t> bytes, const wire::ClientMessage*& message) {
  if (bytes.size() > kMaxClientMessageBytes) return ParseResult::kTooLarge;
  const auto* root = IsAligned(bytes) ? VerifyRoot<wire::ClientMessage>(bytes) : nullptr;
  if (root == nullptr) return ParseResult::kMalformed;
  if (root->body() == nullptr) return ParseResult::kMissingField;
  ParseResult result = ParseResult::kOutOfRange;  // a body of a kind this version does not know
  if (const auto* hello = root->body_as_Hello()) result = CheckHello(*hello);
  if (const auto* input = root->body_as_Input()) result = CheckInput(*input);
  if (const auto* goodbye = root->body_as_Goodbye()) result = CheckGoodbye(*goodbye);
  if (result == ParseResult::kOk) message = root;
  return result;
}

ParseResult ParseServerMessage(std::span<const std::uint8_t> bytes, const wire::ServerMessage*& message) {
  if (bytes.size() > kMaxServerMessageBytes) return ParseResult::kTooLarge;
  const auto* root = IsAligned(bytes) ? VerifyRoot<wire::ServerMessage>(bytes) : nullptr;
  if (root == nullptr) return ParseResult::kMalformed;
  if (root->body() == nullptr) return ParseResult::kMissingField;
  ParseResult result = ParseResult::kOutOfRange;
  if (const auto* welcome = root->body_as_Welcome()) result = CheckWelcome(*welcome);
  if (const auto* chunk = root->body_as_BlueprintChunk()) result = CheckChunk(*chunk);
  if (const auto* rows = root->body_as_HeightRows()) result = CheckRows(*rows);
  if (const auto* event = root->body_as_Event()) result = CheckEvent(*event);
  if (const auto* goodbye = root->body_as_Goodbye()) result = CheckGoodbye(*goodbye);
  if (result == ParseResult::kOk) message = root;
  return result;
}

ParseResult ParseBlueprint(std::span<const std::uint8_t> bytes, const wire::Blueprint*& blueprint) {
  if (bytes.size() > kMaxBlueprintBytes) return ParseResult::kTooLarge;
  const auto* root = IsAligned(bytes) ? VerifyRoot<wire::Blueprint>(bytes) : nullptr;
  if (root == nullptr) return ParseResult::kMalformed;
  if (root->name() == nullptr || root->rest() == nullptr || root->rest()->size() == 0 || root->faces() == nullptr) {
    return ParseResult::kMissingField;
  }
  const std::size_t count = root->rest()->size();
  if (count > kMaxBodyVertices || !(root->size() > 0.0F) || !std::isfinite(root->size())) {
    return ParseResult::kOutOfRange;
  }
  for (const wire::Vec3* vertex : *root->rest()) {
    if (!IsFinite(*vertex)) return ParseResult::kOutOfRange;
  }
  for (const wire::Face* face : *root->faces()) {
    if (face->a() >= count || face->b() >= count || face->c() >= count) return ParseResult::kOutOfRange;
  }
  if (root->edges() != nullptr) {
    if (root->edges()->size() > kMaxBlueprintEdges) return ParseResult::kOutOfRange;
    for (const wire::Edge* edge : *root->edges()) {
      if (edge->a() >= count || edge->b() >= count) return ParseResult::kOutOfRange;
    }
  }
  if (root->bases() != nullptr) {
    if (root->bases()->size() != (count + kMaxPatchVertices - 1) / kMaxPatchVertices) return ParseResult::kOutOfRange;
    for (const wire::Basis* basis : *root->bases()) {
      if (basis->bytes() == nullptr) return ParseResult::kMissingField;
      if (basis->bytes()->size() > kMaxBasisBytes) return ParseResult::kOutOfRange;
    }
  }
  blueprint = root;
  return ParseResult::kOk;
}

Message MakeHello(std::string_view name, wire::Role role, std::uint16_t version, std::uint64_t schemaHash) {
  assert(name.size() <= kMaxNameBytes);
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(name.data(), name.size());
  return FinishClientMessage(builder, wire::CreateHello(builder, version, schemaHash, text, role));
}

Message MakeInput(std::span<const wire::InputFrame> frames, std::uint32_t ackedSequence, std::uint64_t ackedHistory) {
  assert(!frames.empty() && frames.size() <= kMaxInputFrames);
  FlatBufferBuilder builder;
  const auto vector = builder.CreateVectorOfStructs(frames.data(), frames.size());
  return FinishClientMessage(builder, wire::CreateInput(builder, vector, ackedSequence, ackedHistory));
}

Message MakeClientGoodbye(wire::GoodbyeReason reason, std::string_view detail) {
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(detail.data(), detail.size());
  return FinishClientMessage(builder, wire::CreateGoodbye(builder, reason, text));
}

Message MakeWelcome(const WelcomeFields& fields) {
  FlatBufferBuilder builder;
  const auto scene = builder.CreateString(fields.scene);
  const auto obstacles = builder.CreateVectorOfStructs(fields.obstacles);
  const auto heightFields = builder.CreateVectorOfStructs(fields.heightFields);
  return FinishServerMessage(
      builder, wire::CreateWelcome(builder, fields.clientId, fields.ownBody, fields.tick, fields.tickHz,
                                   fields.snapshotHz, scene, fields.blueprintCount, obstacles, heightFields));
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
                  std::string_view name) {
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(name.data(), name.size());
  return FinishServerMessage(builder, wire::CreateEvent(builder, kind, tick, clientId, body, text));
}

Message MakeServerGoodbye(wire::GoodbyeReason reason, std::string_view detail) {
  FlatBufferBuilder builder;
  const auto text = builder.CreateString(detail.data(), detail.size());
  return FinishServerMessage(builder, wire::CreateGoodbye(builder, reason, text));
}

Message MakeBlueprint(std::string_view name, std::span<const Vector3> rest,
                      std::span<const std::array<std::uint16_t, 3>> faces, float size,
                      std::span<const std::array<std::uint16_t, 2>> edges,
                      std::span<const std::vector<std::uint8_t>> bases) {
  assert(edges.size() <= kMaxBlueprintEdges);
  FlatBufferBuilder builder;
  std::vector<wire::Vec3> wireRest(rest.size());
  std::transform(rest.begin(), rest.end(), wireRest.begin(), ToWire);
  std::vector<wire::Face> wireFaces;
  wireFaces.reserve(faces.size());
  for (const auto& face : faces) wireFaces.emplace_back(face[0], face[1], face[2]);
  const auto text = builder.CreateString(name.data(), name.size());
  const auto restVector = builder.CreateVectorOfStructs(wireRest);
  const auto faceVector = builder.CreateVectorOfStructs(wireFaces);
  std::vector<wire::Edge> wireEdges;
  wireEdges.reserve(edges.size());
  for (const auto& edge : edges) wireEdges.emplace_back(edge[0], edge[1]);
  const auto edgeVector =
      edges.empty() ? Offset<flatbuffers::Vector<const wire::Edge*>>() : builder.CreateVectorOfStructs(wireEdges);
  std::vector<Offset<wire::Basis>> wireBases;
  for (const std::vector<std::uint8_t>& basis : bases) {
    wireBases.push_back(wire::CreateBasis(builder, builder.CreateVector(basis)));
  }
  const auto basisVector =
      bases.empty() ? Offset<flatbuffers::Vector<Offset<wire::Basis>>>() : builder.CreateVector(wireBases);
  builder.Finish(wire::CreateBlueprint(builder, text, restVector, faceVector, size, edgeVector, basisVector));
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
  }
  return "unknown reason";
}

}  // namespace wobble::protocol
