// Verification of bytes from the wire. FlatBuffers' verifier goes first, over the whole message. Then come the rules
// that only this protocol knows: mandatory fields are there, numbers are finite, enumerators known, counts within
// limits.h and indices within what they point into.
#include <cmath>
#include <initializer_list>

#include "protocol/messages.h"
#include "protocol/snapshot.h"

namespace wobble::protocol {
namespace {

template <class Root>
const Root* VerifyRoot(std::span<const std::uint8_t> bytes, std::uint32_t maxTables = kMaxMessageTables) {
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxMessageDepth, maxTables);
  return verifier.VerifyBuffer<Root>(nullptr) ? flatbuffers::GetRoot<Root>(bytes.data()) : nullptr;
}

// FlatBuffers reads numbers in place, so its verifier needs an alignment that a network buffer need not have. Every
// transport hands out buffers of the allocator or ENet's packets, both aligned to 8; a caller with another buffer gets
// kMalformed, not undefined behaviour.
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
  const std::size_t kept = hello.kept() == nullptr ? 0 : hello.kept()->size();
  const bool isGood =
      hello.name()->size() <= kMaxNameBytes && IsKnown(hello.role(), wire::Role::MAX) && kept <= kMaxKeptBlueprints;
  return isGood ? ParseResult::kOk : ParseResult::kOutOfRange;
}

bool IsFinite(const wire::Vec3& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

ParseResult CheckInput(const wire::Input& input) {
  if (input.frames() == nullptr || input.frames()->size() == 0) return ParseResult::kMissingField;
  if (input.frames()->size() > kMaxInputFrames) return ParseResult::kOutOfRange;
  for (const wire::InputFrame* frame : *input.frames()) {
    if (frame->buttons() > 7 || frame->move_x() == -128 || frame->move_y() == -128) return ParseResult::kOutOfRange;
  }
  const bool isGood = input.hand() == nullptr || IsFinite(input.hand()->target());
  return isGood ? ParseResult::kOk : ParseResult::kOutOfRange;
}

// All must be there and finite.
ParseResult CheckPlaces(std::initializer_list<const wire::Vec3*> places) {
  for (const wire::Vec3* place : places) {
    if (place == nullptr) return ParseResult::kMissingField;
    if (!IsFinite(*place)) return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

ParseResult CheckTune(const wire::Tune& tune) {
  if (!IsKnown(tune.kind(), wire::TuneKind::MAX)) return ParseResult::kOutOfRange;
  return CheckPlaces({tune.value()});
}

ParseResult CheckBuild(const wire::Build& build) {
  const bool isGood = IsKnown(build.kind(), wire::BuildKind::MAX) && std::isfinite(build.mass()) &&
                      std::isfinite(build.stiffness()) && std::isfinite(build.damping()) &&
                      std::isfinite(build.rest_length());
  return isGood ? CheckPlaces({build.at()}) : ParseResult::kOutOfRange;
}

ParseResult CheckText(const flatbuffers::String* text, std::size_t maxBytes) {
  if (text == nullptr) return ParseResult::kMissingField;
  return text->size() <= maxBytes ? ParseResult::kOk : ParseResult::kOutOfRange;
}

// False for NaN. What a record is decoded with must be bounded, not only finite: two large numbers have an infinite
// product, the difference of two of those is NaN, and NaN as an integer is undefined behaviour.
bool IsInWorld(float number) { return std::fabs(number) <= static_cast<float>(kWorldHalfExtent); }
bool IsInWorld(const wire::Vec3& v) { return IsInWorld(v.x()) && IsInWorld(v.y()) && IsInWorld(v.z()); }

bool IsUnit(const wire::Vec3& v) {
  const float length = std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
  return std::fabs(length - 1) <= kUnitTolerance;
}

bool IsGood(const wire::Obstacle& obstacle) {
  if (!IsInWorld(obstacle.a()) || !IsInWorld(obstacle.b()) || !IsInWorld(obstacle.radius())) return false;
  switch (obstacle.kind()) {
    case wire::ObstacleKind::Plane:
      return IsUnit(obstacle.a());
    case wire::ObstacleKind::Box:
      return obstacle.b().x() >= 0 && obstacle.b().y() >= 0 && obstacle.b().z() >= 0;
    case wire::ObstacleKind::Sphere:
    case wire::ObstacleKind::Capsule:
      return obstacle.radius() > 0;
  }
  return false;
}

bool IsGood(const wire::HeightField& field) {
  const auto fits = [](std::uint16_t nodes) { return nodes >= 2 && nodes <= kMaxFieldNodes; };
  const float lowest = field.corner().z() + field.low();
  return fits(field.columns()) && fits(field.rows()) && IsInWorld(field.corner()) && field.cell_size() > 0 &&
         IsInWorld(field.cell_size()) && IsInWorld(field.low()) && field.step() >= 0 && IsInWorld(lowest) &&
         IsInWorld(lowest + field.step() * 65535.0F);
}

// Also what no scene would have, so that a client may compute with it.
bool IsGood(const wire::Drive& drive) {
  const auto isGood = [](float number) { return number >= 0 && IsInWorld(number); };
  return isGood(drive.acceleration()) && isGood(drive.speed()) && isGood(drive.jump_speed());
}

ParseResult CheckWelcome(const wire::Welcome& welcome) {
  if (welcome.scene() == nullptr || welcome.obstacles() == nullptr || welcome.height_fields() == nullptr ||
      welcome.game() == nullptr) {
    return ParseResult::kMissingField;
  }
  if (welcome.tick_hz() == 0 || welcome.snapshot_hz() == 0 || welcome.blueprint_count() > kMaxBlueprints ||
      welcome.obstacles()->size() > kMaxObstacles || welcome.height_fields()->size() > kMaxHeightFields ||
      welcome.hands() > 15 || !(welcome.reach() >= 0.0F) || welcome.game()->size() > kMaxNameBytes ||
      !IsKnown(welcome.rank(), wire::Rank::MAX) || (welcome.drive() != nullptr && !IsGood(*welcome.drive())) ||
      welcome.talk() > 3 ||
      (welcome.description() != nullptr && welcome.description()->size() > kMaxDescriptionBytes) ||
      (welcome.own_blueprint() >= welcome.blueprint_count() && welcome.blueprint_count() > 0)) {
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
  const bool isKept = chunk.offset() == chunk.total();
  if (chunk.bytes() == nullptr || (chunk.bytes()->size() == 0 && !isKept)) return ParseResult::kMissingField;
  if (chunk.generation() >= kGenerations || chunk.total() > kMaxBlueprintBytes ||
      chunk.bytes()->size() > kBlueprintChunkBytes || chunk.offset() > chunk.total() ||
      chunk.bytes()->size() > chunk.total() - chunk.offset()) {
    return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

ParseResult CheckEvent(const wire::Event& event) {
  if (!IsKnown(event.kind(), wire::EventKind::MAX) || !IsKnown(event.emote(), wire::EmoteKind::MAX)) {
    return ParseResult::kOutOfRange;
  }
  return CheckText(event.name(), event.kind() == wire::EventKind::Said ? kMaxSaidBytes : kMaxNameBytes);
}

ParseResult CheckTuning(const wire::Tuning& tuning) {
  const bool isGood = std::isfinite(tuning.stiffness()) && tuning.stiffness() > 0.0F && tuning.may() <= 7 &&
                      tuning.time_rate() > 0.0F && tuning.time_rate() <= 1.0F;
  return isGood ? CheckPlaces({tuning.gravity()}) : ParseResult::kOutOfRange;
}

ParseResult CheckForces(const wire::Forces& forces) {
  if (forces.sets() == nullptr) return ParseResult::kMissingField;
  if (forces.stride() == 0 || forces.sets()->size() > static_cast<std::size_t>(wire::ForceKind::MAX) + 1) {
    return ParseResult::kOutOfRange;
  }
  for (const wire::ForceSet* set : *forces.sets()) {
    if (set->values() == nullptr) return ParseResult::kMissingField;
    const bool isGood = IsKnown(set->kind(), wire::ForceKind::MAX) && set->values()->size() % 3 == 0 &&
                        set->values()->size() <= 3 * kMaxShownForces && std::isfinite(set->scale());
    if (!isGood) return ParseResult::kOutOfRange;
  }
  return ParseResult::kOk;
}

ParseResult CheckScoreboard(const wire::Scoreboard& board) {
  if (board.scores() == nullptr) return ParseResult::kMissingField;
  bool isGood = IsKnown(board.phase(), wire::GamePhase::MAX) && board.scores()->size() <= kMaxScores &&
                board.winning_side() <= kSides && (board.sides() == nullptr || board.sides()->size() == kSides);
  if (board.seats() != nullptr) {
    isGood = isGood && board.seats()->size() == board.scores()->size();
    for (const wire::Seat* seat : *board.seats()) isGood = isGood && seat->side() <= kSides;
  }
  return isGood ? ParseResult::kOk : ParseResult::kOutOfRange;
}

ParseResult CheckTags(const wire::Blueprint& blueprint) {
  const std::size_t edges = blueprint.edges() == nullptr ? 0 : blueprint.edges()->size();
  if (blueprint.particles() != nullptr) {
    if (blueprint.particles()->size() != blueprint.rest()->size()) return ParseResult::kOutOfRange;
    for (const wire::ParticleTag* tag : *blueprint.particles()) {
      if (!std::isfinite(tag->mass())) return ParseResult::kOutOfRange;
    }
  }
  if (blueprint.springs() != nullptr) {
    if (blueprint.springs()->size() != edges) return ParseResult::kOutOfRange;
    for (const wire::SpringTag* tag : *blueprint.springs()) {
      const bool isGood =
          std::isfinite(tag->stiffness()) && std::isfinite(tag->damping()) && std::isfinite(tag->rest_length());
      if (!isGood) return ParseResult::kOutOfRange;
    }
  }
  return ParseResult::kOk;
}

ParseResult CheckClientBody(const wire::ClientMessage& message) {
  if (const auto* hello = message.body_as_Hello()) return CheckHello(*hello);
  if (const auto* input = message.body_as_Input()) return CheckInput(*input);
  if (const auto* goodbye = message.body_as_Goodbye()) return CheckGoodbye(*goodbye);
  if (const auto* push = message.body_as_Push()) return CheckPlaces({push->direction()});
  if (const auto* cut = message.body_as_Cut()) return CheckPlaces({cut->eye(), cut->from(), cut->to()});
  if (message.body_as_Inspect() != nullptr) return ParseResult::kOk;
  if (const auto* tune = message.body_as_Tune()) return CheckTune(*tune);
  if (const auto* build = message.body_as_Build()) return CheckBuild(*build);
  if (const auto* order = message.body_as_Order()) return CheckText(order->line(), kMaxOrderBytes);
  if (const auto* say = message.body_as_Say()) return CheckText(say->text(), kMaxSaidBytes);
  if (const auto* rename = message.body_as_Rename()) return CheckText(rename->name(), kMaxNameBytes);
  if (const auto* emote = message.body_as_Emote()) {
    return IsKnown(emote->kind(), wire::EmoteKind::MAX) ? ParseResult::kOk : ParseResult::kOutOfRange;
  }
  return ParseResult::kOutOfRange;  // a kind that this version does not know
}

ParseResult CheckServerBody(const wire::ServerMessage& message) {
  if (const auto* welcome = message.body_as_Welcome()) return CheckWelcome(*welcome);
  if (const auto* chunk = message.body_as_BlueprintChunk()) return CheckChunk(*chunk);
  if (const auto* rows = message.body_as_HeightRows()) return CheckRows(*rows);
  if (const auto* event = message.body_as_Event()) return CheckEvent(*event);
  if (const auto* goodbye = message.body_as_Goodbye()) return CheckGoodbye(*goodbye);
  if (const auto* tuning = message.body_as_Tuning()) return CheckTuning(*tuning);
  if (const auto* forces = message.body_as_Forces()) return CheckForces(*forces);
  if (const auto* board = message.body_as_Scoreboard()) return CheckScoreboard(*board);
  if (const auto* notice = message.body_as_Notice()) return CheckText(notice->text(), kMaxNoticeBytes);
  if (const auto* next = message.body_as_NextScene()) {
    return next->scene() == nullptr ? ParseResult::kMissingField : ParseResult::kOk;
  }
  return ParseResult::kOutOfRange;
}

}  // namespace

ParseResult ParseClientMessage(std::span<const std::uint8_t> bytes, const wire::ClientMessage*& message) {
  if (bytes.size() > kMaxClientMessageBytes) return ParseResult::kTooLarge;
  const auto* root = IsAligned(bytes) ? VerifyRoot<wire::ClientMessage>(bytes) : nullptr;
  if (root == nullptr) return ParseResult::kMalformed;
  if (root->body() == nullptr) return ParseResult::kMissingField;
  const ParseResult result = CheckClientBody(*root);
  if (result == ParseResult::kOk) message = root;
  return result;
}

ParseResult ParseServerMessage(std::span<const std::uint8_t> bytes, const wire::ServerMessage*& message) {
  if (bytes.size() > kMaxServerMessageBytes) return ParseResult::kTooLarge;
  const auto* root = IsAligned(bytes) ? VerifyRoot<wire::ServerMessage>(bytes) : nullptr;
  if (root == nullptr) return ParseResult::kMalformed;
  if (root->body() == nullptr) return ParseResult::kMissingField;
  const ParseResult result = CheckServerBody(*root);
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
  if (count > kMaxBodyVertices || !(root->size() >= kMinBodySize) || !std::isfinite(root->size())) {
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
    if (root->bases()->size() != PatchCount(count)) return ParseResult::kOutOfRange;
    for (const wire::Basis* basis : *root->bases()) {
      if (basis->bytes() == nullptr) return ParseResult::kMissingField;
      if (basis->bytes()->size() > kMaxBasisBytes) return ParseResult::kOutOfRange;
    }
  }
  if (const ParseResult tags = CheckTags(*root); tags != ParseResult::kOk) return tags;
  blueprint = root;
  return ParseResult::kOk;
}

}  // namespace wobble::protocol
