// The same bytes as a client's message, a server's message and a blueprint; what is called good is read in full.
//
// The bytes are copied first: libFuzzer's need not be aligned as a transport's are, and a block of exactly their size
// shows any read past the end.
#include "protocol/messages.h"

#include <algorithm>

#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

unsigned Sum(const flatbuffers::String& text) {
  unsigned sum = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) sum += static_cast<std::uint8_t>(text.c_str()[i]);
  return sum;
}

unsigned Read(const wire::ClientMessage& message) {
  if (const auto* hello = message.body_as_Hello()) return Sum(*hello->name()) + hello->protocol_version();
  if (const auto* goodbye = message.body_as_Goodbye()) return Sum(*goodbye->detail());
  const auto* input = message.body_as_Input();
  Require(input != nullptr && input->frames()->size() <= protocol::kMaxInputFrames);
  unsigned sum = input->acked_sequence() + static_cast<unsigned>(input->acked_history());
  for (const wire::InputFrame* frame : *input->frames()) sum += frame->tick() + frame->buttons();
  return sum;
}

unsigned Read(const wire::ServerMessage& message) {
  if (const auto* event = message.body_as_Event()) return Sum(*event->name()) + event->body();
  if (const auto* goodbye = message.body_as_Goodbye()) return Sum(*goodbye->detail());
  unsigned sum = 0;
  if (const auto* welcome = message.body_as_Welcome()) {
    for (const wire::Obstacle* obstacle : *welcome->obstacles()) sum += obstacle->b().z() > 0;
    for (const wire::HeightField* field : *welcome->height_fields()) {
      Require(field->columns() >= 2 && field->rows() >= 2);
      sum += field->low() > 0;
    }
    return sum + Sum(*welcome->scene());
  }
  if (const auto* rows = message.body_as_HeightRows()) {
    for (const std::uint16_t height : *rows->heights()) sum += height;
    return sum;
  }
  const auto* chunk = message.body_as_BlueprintChunk();
  Require(chunk != nullptr && chunk->offset() + chunk->bytes()->size() <= chunk->total());
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
