// Control messages and inputs, which both ends must agree on: how they are made and how bytes from the wire are
// verified.
//
// A parsed message is a view of the bytes it was parsed from. It is verified in full before anything is read, so every
// accessor is safe; what FlatBuffers cannot know (a missing body, too many frames) is checked as well.
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
  kTooLarge,      // over the limit for this sender
  kMalformed,     // fails FlatBuffers' verification, or does not begin at a multiple of 8 bytes
  kMissingField,  // a field that every honest sender sets is absent
  kOutOfRange,    // a field has a value that it cannot have
};
inline constexpr std::size_t kParseResultCount = 5;
[[nodiscard]] const char* Name(ParseResult result);
[[nodiscard]] const char* Name(wire::GoodbyeReason reason);
// The detail of ServerFull that a locked server gives: it has the reason of a full one, by which clients try again.
inline constexpr std::string_view kLockedDetail = "the server is locked, its host lets nobody in at present";
// Reason and detail in a line for people; detail: without control characters.
[[nodiscard]] std::string DescribeGoodbye(wire::GoodbyeReason reason, std::string_view detail);

// Verify bytes of any content. `message` is set only when the result is kOk: its body is then there and of a known
// type, numbers are finite and counts within limits.h.
[[nodiscard]] ParseResult ParseClientMessage(std::span<const std::uint8_t> bytes, const wire::ClientMessage*& message);
[[nodiscard]] ParseResult ParseServerMessage(std::span<const std::uint8_t> bytes, const wire::ServerMessage*& message);
// The same of a blueprint, put together from its chunks: faces and edges name vertices that exist.
[[nodiscard]] ParseResult ParseBlueprint(std::span<const std::uint8_t> bytes, const wire::Blueprint*& blueprint);

using Message = std::vector<std::uint8_t>;

// kept: at most kMaxKeptBlueprints.
[[nodiscard]] Message MakeHello(std::string_view name, wire::Role role, std::span<const std::uint64_t> kept = {},
                                std::uint16_t version = kProtocolVersion, std::uint64_t schemaHash = kSchemaHash,
                                bool isBot = false);
struct InputFields {
  std::span<const wire::InputFrame> frames = {};  // newest first, 1 to kMaxInputFrames
  std::uint32_t ackedSequence = 0;
  std::uint64_t ackedHistory = 0;
  const wire::Hand* hand = nullptr;  // nullptr: empty
  std::uint32_t stalls = 0;          // as messages.fbs says
  std::uint32_t downloaded = 0;      // likewise
};
[[nodiscard]] Message MakeInput(const InputFields& fields);
[[nodiscard]] Message MakeClientGoodbye(wire::GoodbyeReason reason, std::string_view detail);

[[nodiscard]] Message MakePush(std::uint32_t body, std::uint16_t vertex, const Vector3& direction);
[[nodiscard]] Message MakeCut(std::uint32_t body, const Vector3& eye, const Vector3& from, const Vector3& to);
[[nodiscard]] Message MakeInspect(std::uint32_t body);
[[nodiscard]] Message MakeTune(wire::TuneKind kind, const Vector3& value);
// As messages.fbs says which of them count.
struct BuildFields {
  wire::BuildKind kind = wire::BuildKind::AddParticle;
  std::uint16_t a = 0;
  std::uint16_t b = 0;
  Vector3 at = {};
  float mass = 1;
  bool fixed = false;
  float stiffness = 100;
  float damping = 1;
  float restLength = 0;
};
[[nodiscard]] Message MakeBuild(const BuildFields& fields);
// line: at most kMaxOrderBytes.
[[nodiscard]] Message MakeOrder(std::string_view line);
// text: at most kMaxSaidBytes; name: at most kMaxNameBytes.
[[nodiscard]] Message MakeSay(std::string_view text);
[[nodiscard]] Message MakeEmote(wire::EmoteKind kind);
[[nodiscard]] Message MakeRename(std::string_view name);

// Bits of WelcomeFields::hands, WelcomeFields::talk and TuningFields::may.
inline constexpr std::uint8_t kMayGrab = 1, kMayCut = 2, kMayPush = 4, kMayBuild = 8;
inline constexpr std::uint8_t kMaySay = 1, kMayEmote = 2;
inline constexpr std::uint8_t kMayTuneGravity = 1, kMayTuneStiffness = 2, kMayTuneTime = 4;

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
  std::uint8_t hands = 0;
  float reach = 0;             // m; 0: any distance
  std::string game = {};       // empty: none
  std::uint32_t workshop = 0;  // body; 0: none
  std::uint8_t ownBlueprint = 0;
  wire::Rank rank = wire::Rank::Player;
  wire::Drive drive = {};        // of the own body; a speed of 0: none
  std::string description = {};  // at most kMaxDescriptionBytes
  std::uint8_t talk = 0;         // bits kMaySay, kMayEmote
};
[[nodiscard]] Message MakeWelcome(const WelcomeFields& fields);
// bytes: at most kBlueprintChunkBytes; none, with an offset of `total`, for a blueprint that the client has kept.
[[nodiscard]] Message MakeBlueprintChunk(std::uint8_t blueprint, std::uint64_t hash, std::uint32_t total,
                                         std::uint32_t offset, std::span<const std::uint8_t> bytes,
                                         std::uint8_t generation = 0);
// heights: 1..kMaxRowsHeights.
[[nodiscard]] Message MakeHeightRows(std::uint16_t field, std::uint16_t firstRow,
                                     std::span<const std::uint16_t> heights);
[[nodiscard]] Message MakeEvent(wire::EventKind kind, std::uint32_t tick, std::uint32_t clientId, std::uint32_t body,
                                std::string_view name, wire::EmoteKind emote = wire::EmoteKind::Wave);
[[nodiscard]] Message MakeServerGoodbye(wire::GoodbyeReason reason, std::string_view detail);

struct TuningFields {
  Vector3 gravity{0, 0, -9.81F};  // m/s²
  float stiffness = 1;            // factor of every spring's stiffness and damping
  float timeRate = 1;             // seconds of the world a second
  std::uint8_t may = 0;           // what the receiver may tune: bits kMayTune...
};
[[nodiscard]] Message MakeTuning(const TuningFields& fields);

// One kind of force on each of the vertices shown, N (acceleration: m/s²).
struct ForceField {
  wire::ForceKind kind = wire::ForceKind::Elastic;
  std::vector<Vector3> values = {};
};
// fields: of equally many vertices, at most kMaxShownForces. Each is sent in steps of 1/kForceSteps of its largest
// coordinate; a field of zeros is left out.
[[nodiscard]] Message MakeForces(std::uint32_t body, std::uint32_t tick, std::uint16_t stride,
                                 std::span<const ForceField> fields);

struct ScoreboardFields {
  wire::GamePhase phase = wire::GamePhase::Playing;
  std::uint16_t round = 0;
  std::uint16_t secondsLeft = 0;  // of the phase
  std::uint16_t pointsToWin = 0;
  std::uint32_t winner = 0;                 // of the last round, or the match; 0: nobody
  std::vector<wire::Score> scores = {};     // at most kMaxScores
  std::uint16_t rounds = 0;                 // that make a match; 0: it never ends
  std::vector<wire::Seat> seats = {};       // one for each score
  std::vector<wire::SideScore> sides = {};  // two, or none
  std::uint8_t winningSide = 0;             // 0: none
  std::uint32_t object = 0;                 // the ball or the crown; 0: none
  std::uint32_t bearer = 0;                 // client who wears the crown; 0: nobody
};
[[nodiscard]] Message MakeScoreboard(const ScoreboardFields& fields);
// text: at most kMaxNoticeBytes.
[[nodiscard]] Message MakeNotice(std::string_view text);
// scene: the name that the next welcome gives.
[[nodiscard]] Message MakeNextScene(std::string_view scene);

// All that a client needs to draw a body. It becomes one FlatBuffer and is sent in chunks.
struct BlueprintFields {
  std::string_view name;
  std::span<const Vector3> rest;
  std::span<const std::array<std::uint16_t, 3>> faces = {};
  float size = 1;
  std::span<const std::array<std::uint16_t, 2>> edges = {};  // at most kMaxBlueprintEdges
  std::span<const std::vector<std::uint8_t>> bases = {};     // as WriteBasis makes them, one a patch or none
  std::span<const wire::ParticleTag> particles = {};         // one a vertex or none
  std::span<const wire::SpringTag> springs = {};             // one an edge or none
};
[[nodiscard]] Message MakeBlueprint(const BlueprintFields& fields);
// FNV-1a, 64 bits. Names a blueprint in a client's cache; no defence against forgery.
[[nodiscard]] std::uint64_t HashBytes(std::span<const std::uint8_t> bytes);

}  // namespace wobble::protocol
