// The same bytes as a client's message, a server's message and a blueprint; those that are accepted are read in full.
//
// The bytes are copied first: libFuzzer's need not be aligned as those of a transport are, and a block of exactly their
// size shows any read past the end.
#include "protocol/messages.h"

#include <algorithm>
#include <cmath>

#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

unsigned Sum(const flatbuffers::String& text) {
  unsigned sum = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) sum += static_cast<std::uint8_t>(text.c_str()[i]);
  return sum;
}

unsigned ReadPlace(const wire::Vec3& place) {
  Require(std::isfinite(place.x()) && std::isfinite(place.y()) && std::isfinite(place.z()));
  return place.z() > 0;
}

unsigned Read(const wire::Hello& hello) {
  unsigned sum = Sum(*hello.name()) + hello.protocol_version();
  if (hello.kept() == nullptr) return sum;
  Require(hello.kept()->size() <= protocol::kMaxKeptBlueprints);
  for (const std::uint64_t hash : *hello.kept()) sum += static_cast<unsigned>(hash);
  return sum;
}

unsigned Read(const wire::ClientMessage& message) {
  if (const auto* hello = message.body_as_Hello()) return Read(*hello);
  if (const auto* goodbye = message.body_as_Goodbye()) return Sum(*goodbye->detail());
  if (const auto* push = message.body_as_Push()) return ReadPlace(*push->direction());
  if (const auto* cut = message.body_as_Cut()) {
    return ReadPlace(*cut->eye()) + ReadPlace(*cut->from()) + ReadPlace(*cut->to());
  }
  if (const auto* inspect = message.body_as_Inspect()) return inspect->body();
  if (const auto* tune = message.body_as_Tune()) return ReadPlace(*tune->value());
  if (const auto* build = message.body_as_Build()) {
    Require(build->kind() <= wire::BuildKind::MAX && std::isfinite(build->mass()));
    return ReadPlace(*build->at());
  }
  if (const auto* order = message.body_as_Order()) {
    Require(order->line()->size() <= protocol::kMaxOrderBytes);
    return Sum(*order->line());
  }
  if (const auto* say = message.body_as_Say()) {
    Require(say->text()->size() <= protocol::kMaxSaidBytes);
    return Sum(*say->text());
  }
  if (const auto* rename = message.body_as_Rename()) {
    Require(rename->name()->size() <= protocol::kMaxNameBytes);
    return Sum(*rename->name());
  }
  if (const auto* emote = message.body_as_Emote()) {
    Require(emote->kind() <= wire::EmoteKind::MAX);
    return static_cast<unsigned>(emote->kind());
  }
  const auto* input = message.body_as_Input();
  Require(input != nullptr && input->frames()->size() <= protocol::kMaxInputFrames);
  unsigned sum = input->acked_sequence() + static_cast<unsigned>(input->acked_history()) + input->downloaded();
  for (const wire::InputFrame* frame : *input->frames()) sum += frame->tick() + frame->buttons();
  if (input->hand() != nullptr) sum += ReadPlace(input->hand()->target());
  return sum;
}

unsigned Read(const wire::Forces& forces) {
  unsigned sum = forces.stride();
  Require(sum > 0);
  for (const wire::ForceSet* set : *forces.sets()) {
    Require(set->values()->size() % 3 == 0 && set->values()->size() <= 3 * protocol::kMaxShownForces);
    for (const std::int8_t value : *set->values()) sum += static_cast<std::uint8_t>(value);
  }
  return sum;
}

unsigned Read(const wire::ServerMessage& message) {
  if (const auto* tuning = message.body_as_Tuning()) {
    Require(tuning->time_rate() > 0 && tuning->time_rate() <= 1);
    return ReadPlace(*tuning->gravity());
  }
  if (const auto* forces = message.body_as_Forces()) return Read(*forces);
  if (const auto* board = message.body_as_Scoreboard()) {
    unsigned sum = board->round();
    for (const wire::Score* score : *board->scores()) sum += score->points();
    Require(board->winning_side() <= protocol::kSides);
    Require(board->sides() == nullptr || board->sides()->size() == protocol::kSides);
    if (board->seats() != nullptr) {
      Require(board->seats()->size() == board->scores()->size());
      for (const wire::Seat* seat : *board->seats()) Require(seat->side() <= protocol::kSides);
    }
    return sum;
  }
  if (const auto* notice = message.body_as_Notice()) return Sum(*notice->text());
  if (const auto* next = message.body_as_NextScene()) return Sum(*next->scene());
  if (const auto* event = message.body_as_Event()) {
    Require(event->emote() <= wire::EmoteKind::MAX);
    return Sum(*event->name()) + event->body();
  }
  if (const auto* goodbye = message.body_as_Goodbye()) return Sum(*goodbye->detail());
  unsigned sum = 0;
  if (const auto* welcome = message.body_as_Welcome()) {
    Require(welcome->rank() <= wire::Rank::MAX);
    Require(welcome->own_blueprint() < welcome->blueprint_count() || welcome->blueprint_count() == 0);
    for (const wire::Obstacle* obstacle : *welcome->obstacles()) sum += obstacle->b().z() > 0;
    for (const wire::HeightField* field : *welcome->height_fields()) {
      Require(field->columns() >= 2 && field->rows() >= 2);
      sum += field->low() > 0;
    }
    if (welcome->description() != nullptr) sum += Sum(*welcome->description());
    return sum + Sum(*welcome->scene()) + Sum(*welcome->game());
  }
  if (const auto* rows = message.body_as_HeightRows()) {
    for (const std::uint16_t height : *rows->heights()) sum += height;
    return sum;
  }
  const auto* chunk = message.body_as_BlueprintChunk();
  Require(chunk != nullptr && chunk->offset() + chunk->bytes()->size() <= chunk->total());
  Require(chunk->bytes()->size() > 0 || chunk->offset() == chunk->total());
  for (const std::uint8_t byte : *chunk->bytes()) sum += byte;
  return sum;
}

unsigned Read(const wire::Blueprint& blueprint) {
  unsigned sum = Sum(*blueprint.name());
  for (const wire::Vec3* vertex : *blueprint.rest()) sum += vertex->z() > 0;
  for (const wire::Face* face : *blueprint.faces()) {
    Require(std::max({face->a(), face->b(), face->c()}) < blueprint.rest()->size());
  }
  if (blueprint.edges() != nullptr) {
    for (const wire::Edge* edge : *blueprint.edges()) {
      Require(std::max(edge->a(), edge->b()) < blueprint.rest()->size());
    }
  }
  if (blueprint.particles() != nullptr) {
    Require(blueprint.particles()->size() == blueprint.rest()->size());
    for (const wire::ParticleTag* tag : *blueprint.particles()) sum += tag->mass() > 0 ? tag->number() : 0U;
  }
  if (blueprint.springs() != nullptr) {
    for (const wire::SpringTag* tag : *blueprint.springs()) sum += tag->stiffness() > 0 ? tag->number() : 0U;
  }
  return sum;
}

void FuzzOne(std::span<const std::uint8_t> bytes) {
  const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
  const wire::ClientMessage* client = nullptr;
  const wire::ServerMessage* server = nullptr;
  const wire::Blueprint* blueprint = nullptr;
  volatile unsigned sum = 0;  // so that no read is optimised away
  if (protocol::ParseClientMessage(copy, client) == protocol::ParseResult::kOk) sum = sum + Read(*client);
  if (protocol::ParseServerMessage(copy, server) == protocol::ParseResult::kOk) sum = sum + Read(*server);
  if (protocol::ParseBlueprint(copy, blueprint) == protocol::ParseResult::kOk) sum = sum + Read(*blueprint);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
