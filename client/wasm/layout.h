// The structs that the script reads from linear memory. Every field has four bytes; the script has the same
// offsets (client/npm/source/memory.ts). Pointers are addresses in linear memory.
#pragma once

#include <cstdint>
#include <string_view>

#include "protocol/messages.h"

namespace wobble::wasm {

using Address = std::uint32_t;  // in linear memory; in native builds the low half, so tests do not follow it

[[nodiscard]] inline Address AddressOf(const void* pointer) {
  return static_cast<Address>(reinterpret_cast<std::uintptr_t>(pointer));
}

struct Text {
  Address bytes = 0;  // UTF-8
  std::uint32_t length = 0;
};
[[nodiscard]] inline Text MakeText(std::string_view text) {
  return {AddressOf(text.data()), static_cast<std::uint32_t>(text.size())};
}

// A body as it is to be shown. revision: changes whenever vertices or normals do.
struct BodyView {
  std::uint32_t body = 0;
  std::uint32_t blueprint = 0;  // number of a BlueprintView, never reused
  std::uint32_t revision = 0;
  std::uint32_t vertexCount = 0;
  Address vertices = 0;  // three floats each, world, metres
  Address normals = 0;   // three floats each, unit length or zero; of bodies with faces
  float centroid[3] = {};
  float rotation[4] = {};  // w x y z
  std::uint32_t held = 0;  // BodySample::held
};
static_assert(sizeof(BodyView) == 14 * 4);

struct BlueprintView {
  std::uint32_t vertexCount = 0;
  Address rest = 0;  // three floats each, body frame, metres
  std::uint32_t faceCount = 0;
  Address faces = 0;  // three 16-bit vertices each
  std::uint32_t edgeCount = 0;
  Address edges = 0;         // two 16-bit vertices each
  float size = 0;            // metres
  std::uint32_t isOpen = 0;  // the backs of faces are visible
  Text name;
  Address particles = 0;  // wire::ParticleTag, 12 bytes each, one a vertex; or 0
  Address springs = 0;    // wire::SpringTag, 20 bytes each, one an edge; or 0
};
static_assert(sizeof(BlueprintView) == 12 * 4);
static_assert(sizeof(protocol::wire::ParticleTag) == 12 && sizeof(protocol::wire::SpringTag) == 20);

// A blueprint that was downloaded, for the script to keep.
struct DownloadView {
  std::uint32_t hashLow = 0;
  std::uint32_t hashHigh = 0;
  Address bytes = 0;
  std::uint32_t length = 0;
};
static_assert(sizeof(DownloadView) == 4 * 4);

struct GroundView {
  float corner[3] = {};
  float cellSize = 0;
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  Address heights = 0;  // floats, row by row
};
static_assert(sizeof(GroundView) == 7 * 4);

struct WelcomeView {
  std::uint32_t clientId = 0;
  std::uint32_t ownBody = 0;
  std::uint32_t tickHz = 0;
  std::uint32_t snapshotHz = 0;
  Text scene;
  std::uint32_t obstacleCount = 0;
  Address obstacles = 0;  // wire::Obstacle, 32 bytes each
  std::uint32_t groundCount = 0;
  Address grounds = 0;      // GroundView
  std::uint32_t hands = 0;  // bits kMay... of protocol/messages.h
  float reach = 0;          // m; 0: any distance
  Text game;
  std::uint32_t workshop = 0;
  std::uint32_t rank = 0;  // wire::Rank
  Text description;
  std::uint32_t talk = 0;  // bits kMaySay, kMayEmote
};
static_assert(sizeof(WelcomeView) == 19 * 4);
static_assert(sizeof(protocol::wire::Obstacle) == 32);

struct EventView {
  std::uint32_t kind = 0;
  std::uint32_t clientId = 0;
  std::uint32_t body = 0;
  Text name;
  std::uint32_t emote = 0;
};
static_assert(sizeof(EventView) == 6 * 4);

struct StatisticsView {
  float snapshots = 0;
  float records = 0;
  float badMessages = 0;  // control messages, snapshots and records together
  float bytesReceived = 0;
  float stalls = 0;
  float delay = 0;            // s; Client::InterpolationDelay
  float inputToSnapshot = 0;  // s
  float snapshotAge = 0;      // s
  float timeRatio = 0;
  float lossShare = 0;
  float serverTime = 0;  // s
  float joinSeconds = 0;
  float pace = 1;  // Client::Pace
};
static_assert(sizeof(StatisticsView) == 13 * 4);

struct TuningView {
  float gravity[3] = {};
  float stiffness = 1;
  float timeRate = 1;
  std::uint32_t may = 0;
};
static_assert(sizeof(TuningView) == 6 * 4);

struct ScoreboardView {
  std::uint32_t phase = 0;
  std::uint32_t round = 0;
  std::uint32_t secondsLeft = 0;
  std::uint32_t pointsToWin = 0;
  std::uint32_t winner = 0;
  std::uint32_t scoreCount = 0;
  Address scores = 0;  // wire::Score, 8 bytes each
  Address seats = 0;   // wire::Seat, 3 bytes each, as many
  std::uint32_t rounds = 0;
  std::uint32_t winningSide = 0;
  std::uint32_t object = 0;
  std::uint32_t bearer = 0;
  std::uint32_t sideCount = 0;
  Address sides = 0;  // wire::SideScore, 4 bytes each
};
static_assert(sizeof(ScoreboardView) == 14 * 4);
static_assert(sizeof(protocol::wire::Score) == 8 && sizeof(protocol::wire::Seat) == 3);
static_assert(sizeof(protocol::wire::SideScore) == 4);

struct ForceFieldView {
  std::uint32_t kind = 0;
  std::uint32_t count = 0;
  Address values = 0;  // three floats each
};
static_assert(sizeof(ForceFieldView) == 3 * 4);

struct ForcesView {
  std::uint32_t body = 0;
  std::uint32_t tick = 0;
  std::uint32_t stride = 1;
  std::uint32_t fieldCount = 0;
  Address fields = 0;  // ForceFieldView
};
static_assert(sizeof(ForcesView) == 5 * 4);

// The script writes this before it calls Build.
struct BuildRequest {
  std::uint32_t kind = 0;
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  float at[3] = {};
  float mass = 0;
  std::uint32_t fixed = 0;
  float stiffness = 0;
  float damping = 0;
  float restLength = 0;
};
static_assert(sizeof(BuildRequest) == 11 * 4);

}  // namespace wobble::wasm
