// Every number that both ends share, with its unit and what changing it costs.
//
// Changing any of them changes the protocol: raise kProtocolVersion, and STANDARD.md with it. A hello with another
// version is refused, so that two builds never misread each other in silence.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobble::protocol {

// Raised whenever a byte on the wire means something else than before.
inline constexpr std::uint16_t kProtocolVersion = 5;

// A datagram's payload, bytes. 1,200 fits every path's MTU (IPv6's floor is 1,280); ENet would fragment a larger one,
// and a snapshot of ten fragments survives 5 % loss only 60 % of the time.
inline constexpr std::size_t kMaxPacketBytes = 1200;

// The largest control message from server to client, bytes, and from client to server. What a client may make the
// server hold is clients × this; an input is under 200 bytes.
inline constexpr std::size_t kMaxServerMessageBytes = 64 * 1024;
inline constexpr std::size_t kMaxClientMessageBytes = 4 * 1024;

// Blueprints travel in chunks of this many bytes, so that a large one does not hold up the control channel.
inline constexpr std::size_t kBlueprintChunkBytes = 4 * 1024;
// The largest serialised blueprint, bytes: 4,096 vertices with 8,192 faces need about 100 KiB, and their bases may take
// 256 KiB. A client reserves no more.
inline constexpr std::size_t kMaxBlueprintBytes = 512 * 1024;

// FlatBuffers verifier: nesting and table count that any honest message stays far under.
inline constexpr std::uint32_t kMaxMessageDepth = 8;
inline constexpr std::uint32_t kMaxMessageTables = 64;

// Vertices a body, and a patch (a body's part that has a record of its own). A patch of 512 vertices fits a packet at
// 18 bits a vertex; a scene with larger bodies is refused.
inline constexpr std::size_t kMaxBodyVertices = 4096;
inline constexpr std::size_t kMaxPatchVertices = 512;
// A patch's basis, bytes: 110 of a 162-vertex ball's 486 modes as bytes, and the rest in half a byte. A client keeps
// two bytes for each pair of coordinates, 1.2 MB at the most vertices that may have modes of their own; larger patches
// have one number a vertex and mode, 0.5 MB.
inline constexpr std::size_t kMaxBasisBytes = 64 * 1024;
inline constexpr std::size_t kMaxTrainedVertices = 256;
// Blueprints a scene (a record names one in a byte) and bodies a world.
inline constexpr std::size_t kMaxBlueprints = 255;
// Blueprints that one number may mean after each other before a record of an old one could be taken for a new one: five
// bits, which a record has to spare. A number that changed 30 times a second would come round in a second.
inline constexpr unsigned kGenerations = 32;
// Edges of a blueprint, which has them only when it has no faces. With 4,096 vertices these are 180 KiB.
inline constexpr std::size_t kMaxBlueprintEdges = 32768;
inline constexpr std::size_t kMaxBodies = 65535;

// Static surfaces that a welcome may hold: 48 KiB with all of them; of each height field there follow up to 32 KiB.
inline constexpr std::size_t kMaxObstacles = 1024;
inline constexpr std::size_t kMaxHeightFields = 16;
inline constexpr std::size_t kMaxFieldNodes = 128;        // along x and along y
inline constexpr std::size_t kMaxRowsHeights = 2 * 1024;  // in one message

// The world ends here, metres from the origin along each axis: centroids have at most 13 bits before the point.
inline constexpr double kWorldHalfExtent = 8192;

// Packets that an acknowledgement covers: the newest and this many before it.
inline constexpr unsigned kAckHistory = 64;
// Input frames repeated in each input message: at 60 Hz this rides out a loss burst of 66 ms.
inline constexpr std::size_t kInputRedundancy = 4;
inline constexpr std::size_t kMaxInputFrames = 8;
// An input further ahead of the server's tick than this is refused, ticks.
inline constexpr std::uint32_t kMaxInputLeadTicks = 64;

// Characters of a player's name, bytes of UTF-8; and of a line that tells a player why something was not done.
inline constexpr std::size_t kMaxNameBytes = 32;
inline constexpr std::size_t kMaxNoticeBytes = 256;

// Lines of a scoreboard: as many as a server can have clients, in 48 KiB.
inline constexpr std::size_t kMaxScores = 4000;
// Vertices that Forces shows at most: 5.4 KiB for all kinds, ten times a second to whoever has asked.
inline constexpr std::size_t kMaxShownForces = 256;
// Steps of such a force from nothing to the largest of its kind.
inline constexpr float kForceSteps = 127;
// Messages that change something beyond the own body (push, cut, inspect, tune, build), from one client within a
// second. More than hands can do; what comes beyond it is dropped.
inline constexpr unsigned kMaxCommandsPerSecond = 60;

// Seconds. A connection must say hello within the first; a client (or server) silent for the second has gone; without
// a newer input the last one is held for the third, then the player stands still.
inline constexpr double kHelloTimeout = 3;
inline constexpr double kSilenceTimeout = 8;
inline constexpr double kInputHold = 0.1;

// Seconds that a client waits for the first answer. ENet asks again twice in three seconds, and the server its answer:
// over 1 s of delay and 25 % loss each way a handshake fails once in 10,000. Within 5 s it failed once in 40.
inline constexpr double kConnectTimeout = 8;

// While a client joins, hello and welcome may each take several tries, one in one and a half round trips, and neither
// inputs nor snapshots say meanwhile that somebody is there. So until they do, both ends wait this many round trips
// longer than the two timeouts above: five or six tries, which at 25 % loss all fail once in 1,000 to 4,000. A link
// that claims to take longer than kMaxJoinRoundTrip, seconds, gains no more by it.
inline constexpr double kJoinRoundTrips = 8;
inline constexpr double kMaxJoinRoundTrip = 3;
[[nodiscard]] constexpr double FindJoinPatience(double roundTrip) {
  return kJoinRoundTrips * (roundTrip < kMaxJoinRoundTrip ? roundTrip : kMaxJoinRoundTrip);
}

// Messages a client may get wrong within a second, counted from the first wrong one, before it is sent away.
inline constexpr unsigned kMaxBadMessagesPerSecond = 20;

}  // namespace wobble::protocol
