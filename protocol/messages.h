// Control messages and inputs: how they are made, and how bytes from the wire become something to be trusted.
//
// A parsed message is a view into the bytes it was parsed from. It is verified in full before anything is read, so
// every accessor is safe; what FlatBuffers cannot know (a missing body, too many frames) is checked here as well.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/limits.h"
#include "protocol/messages_generated.h"
#include "protocol/schema_hash.h"

namespace wobble::protocol {

namespace wire = wobble::wire;  // what flatc made of messages.fbs

enum class ParseResult : std::uint8_t {
  kOk,
  kTooLarge,      // over the size allowed from this side
  kMalformed,     // fails FlatBuffers' verification
  kMissingField,  // a part that every honest sender sets is absent
  kOutOfRange,    // a field has a value it cannot have
};
inline constexpr std::size_t kParseResultCount = 5;
[[nodiscard]] const char* Name(ParseResult result);
[[nodiscard]] const char* Name(wire::GoodbyeReason reason);

// Sets `message` only when the result is kOk; its body is then set and of a known type.
[[nodiscard]] ParseResult ParseClientMessage(std::span<const std::uint8_t> bytes, const wire::ClientMessage*& message);
[[nodiscard]] ParseResult ParseServerMessage(std::span<const std::uint8_t> bytes, const wire::ServerMessage*& message);
// Faces and edges name vertices that exist, vertices are finite, and the counts are within limits.h.
[[nodiscard]] ParseResult ParseBlueprint(std::span<const std::uint8_t> bytes, const wire::Blueprint*& blueprint);

using Message = std::vector<std::uint8_t>;

[[nodiscard]] Message MakeHello(std::string_view name, wire::Role role, std::uint16_t version = kProtocolVersion,
                                std::uint64_t schemaHash = kSchemaHash);
// frames: newest first, at most kMaxInputFrames.
[[nodiscard]] Message MakeInput(std::span<const wire::InputFrame> frames, std::uint32_t ackedSequence,
                                std::uint64_t ackedHistory);
[[nodiscard]] Message MakeClientGoodbye(wire::GoodbyeReason reason, std::string_view detail);

struct WelcomeFields {
  std::uint32_t clientId = 0;
  std::uint32_t ownBody = 0;  // 0: none
  std::uint32_t tick = 0;
  std::uint16_t tickHz = 0;
  std::uint16_t snapshotHz = 0;
  std::string scene;
  std::uint16_t blueprintCount = 0;
  std::vector<wire::Obstacle> obstacles;
  std::vector<wire::HeightField> heightFields = {};
};
[[nodiscard]] Message MakeWelcome(const WelcomeFields& fields);
[[nodiscard]] Message MakeBlueprintChunk(std::uint8_t blueprint, std::uint64_t hash, std::uint32_t total,
                                         std::uint32_t offset, std::span<const std::uint8_t> bytes,
                                         std::uint8_t generation = 0);
// At most kMaxRowsHeights.
[[nodiscard]] Message MakeHeightRows(std::uint16_t field, std::uint16_t firstRow,
                                     std::span<const std::uint16_t> heights);
[[nodiscard]] Message MakeEvent(wire::EventKind kind, std::uint32_t tick, std::uint32_t clientId, std::uint32_t body,
                                std::string_view name);
[[nodiscard]] Message MakeServerGoodbye(wire::GoodbyeReason reason, std::string_view detail);

// What a client needs to draw a body, as one FlatBuffer; sent in chunks. At most kMaxBlueprintEdges;
// bases: as WriteBasis makes them, one a patch or none.
[[nodiscard]] Message MakeBlueprint(std::string_view name, std::span<const Vector3> rest,
                                    std::span<const std::array<std::uint16_t, 3>> faces, float size,
                                    std::span<const std::array<std::uint16_t, 2>> edges = {},
                                    std::span<const std::vector<std::uint8_t>> bases = {});
// FNV-1a, 64 bits: names a blueprint in a client's cache. Not a defence against forgery.
[[nodiscard]] std::uint64_t HashBytes(std::span<const std::uint8_t> bytes);

}  // namespace wobble::protocol
