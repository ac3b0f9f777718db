// Every number that both ends share, with its unit and the reason for its value.
//
// Changing any of them changes the protocol: raise kProtocolVersion, and STANDARD.md with it. A hello with another
// version is refused, so that two builds never misread each other silently.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobble::protocol {

// Raised whenever a byte on the wire means something else than before.
inline constexpr std::uint16_t kProtocolVersion = 6;

// An input or a snapshot packet, bytes. With the heads of ENet (32), sealing (24), UDP and IPv6 it fits IPv6's smallest
// MTU, 1,280; a larger one would be fragmented, and a snapshot of ten fragments survives 5 % loss only 60 % of the
// time.
inline constexpr std::size_t kMaxPacketBytes = 1176;

// The largest control message from server to client and from client to server, bytes. The second fits one datagram: a
// hello with as many kept blueprints as it may name has 650 bytes, and the vestibule lets no fragment of a client pass.
inline constexpr std::size_t kMaxServerMessageBytes = 64 * 1024;
inline constexpr std::size_t kMaxClientMessageBytes = 1024;

// Blueprints travel in chunks of this many bytes, so that a large one does not hold up the control channel.
inline constexpr std::size_t kBlueprintChunkBytes = 4 * 1024;
// The largest serialised blueprint, bytes: 4,096 vertices with 8,192 faces need about 100 KiB, and their bases may take
// 256 KiB. A client reserves no more.
inline constexpr std::size_t kMaxBlueprintBytes = 512 * 1024;
// Bytes of heights and blueprints that a server has on their way to a client at most: sent, and not yet counted in
// Input::downloaded. All reliable messages that wait behind a lost one must fit the receiver's buffer (enet_host.cpp),
// or the lost one is refused for ever. At 100 ms a round trip the window carries
// 900 kB/s, more than ENet's own window of 64 KiB.
inline constexpr std::size_t kDownloadWindowBytes = 96 * 1024;
// What a piece without bytes, which stands for a kept blueprint, counts there.
inline constexpr std::uint32_t kKeptPieceBytes = 1;
// Hashes of kept blueprints in a hello, and the bytes of kept blueprints that a client holds while it joins.
inline constexpr std::size_t kMaxKeptBlueprints = 64;
inline constexpr std::size_t kMaxKeptBytes = 4 * 1024 * 1024;

// For FlatBuffers' verifier: nesting and number of tables, far above those of any honest message.
inline constexpr std::uint32_t kMaxMessageDepth = 8;
inline constexpr std::uint32_t kMaxMessageTables = 64;

// Vertices of a body, and of a patch (a part of a body with a record of its own). A patch of 512 vertices fits a packet
// at 18 bits a vertex. A scene with larger bodies is refused.
inline constexpr std::size_t kMaxBodyVertices = 4096;
inline constexpr std::size_t kMaxPatchVertices = 512;
// The largest serialised basis of a patch, bytes: of a ball of 162 vertices 110 of its 486 modes as bytes, and the rest
// as half bytes. A client keeps two bytes for each pair of coordinates, 1.2 MB at kMaxTrainedVertices, which is the
// most vertices with a full basis; a larger patch has one number a vertex and mode, 0.5 MB.
inline constexpr std::size_t kMaxBasisBytes = 64 * 1024;
inline constexpr std::size_t kMaxTrainedVertices = 256;
// Blueprints of a scene: a record names one in a byte.
inline constexpr std::size_t kMaxBlueprints = 255;
// Successive blueprints under one number that records can tell apart: five bits, which a record has to spare. A number
// that changed 30 times a second would repeat after a second.
inline constexpr unsigned kGenerations = 32;
// The smallest size of a blueprint, m; honest ones have 0.01 at least. The displacements of a smaller one would be
// infinite in the units in which contact is predicted.
inline constexpr float kMinBodySize = 0.001F;
// Edges of a blueprint, which has them only when it has no faces: with 4,096 vertices 180 KiB.
inline constexpr std::size_t kMaxBlueprintEdges = 32768;
// Bodies of a world.
inline constexpr std::size_t kMaxBodies = 65535;

// Static obstacles of a welcome: 48 KiB with all of them. Up to 32 KiB follow for each height field.
inline constexpr std::size_t kMaxObstacles = 1024;
inline constexpr std::size_t kMaxHeightFields = 16;
inline constexpr std::size_t kMaxFieldNodes = 128;        // along x and along y
inline constexpr std::size_t kMaxRowsHeights = 2 * 1024;  // in one message

// The border of the world, metres from the origin along each axis: centroids have at most 13 bits before the point.
inline constexpr double kWorldHalfExtent = 8192;
// By how much the length of a plane's normal may differ from 1: far more than rounding, and far too little to drive
// points that are pressed out of several planes apart.
inline constexpr float kUnitTolerance = 1e-3F;

// An acknowledgement covers the newest packet and this many before it.
inline constexpr unsigned kAckHistory = 64;
// Input frames in each message of our client: at 60 Hz they survive a loss burst of 66 ms.
inline constexpr std::size_t kInputRedundancy = 4;
// Input frames in a message that the server takes.
inline constexpr std::size_t kMaxInputFrames = 8;
// Ticks by which an input may be ahead of the server; one further ahead is refused.
inline constexpr std::uint32_t kMaxInputLeadTicks = 64;

// Bytes of UTF-8 in a player's name, and in a notice that tells a player why something was not done.
inline constexpr std::size_t kMaxNameBytes = 32;
inline constexpr std::size_t kMaxNoticeBytes = 256;
// Bytes of an order to the server's administration.
inline constexpr std::size_t kMaxOrderBytes = 200;
// Bytes of UTF-8 in a line that a player says, and in a scene's description.
inline constexpr std::size_t kMaxSaidBytes = 200;
inline constexpr std::size_t kMaxDescriptionBytes = 256;

// Lines of a scoreboard: as many as a server can have clients, in 48 KiB.
inline constexpr std::size_t kMaxScores = 4000;
// Sides of a game that has sides.
inline constexpr std::size_t kSides = 2;
// Vertices in a Forces message: 5.4 KiB for all kinds, ten times a second to each client that has asked.
inline constexpr std::size_t kMaxShownForces = 256;
// Steps of a force in it, from 0 to the largest of its kind.
inline constexpr float kForceSteps = 127;
// Commands (push, cut, inspect, tune, build, order, say, emote, rename) from one client within a second: more than
// hands can do. Further ones are dropped.
inline constexpr unsigned kMaxCommandsPerSecond = 60;
// Inputs from one client within a second, or twice the tick rate where that is more: a client sends one a tick. Further
// ones are dropped. After a link that was dead for a while more may come at once, so only who goes on for
// kMaxOverdrawnSeconds with these or with commands is sent away.
inline constexpr unsigned kMaxInputsPerSecond = 120;
inline constexpr double kMaxOverdrawnSeconds = 3;
[[nodiscard]] constexpr unsigned FindMaxInputs(unsigned tickHz) {
  return 2 * tickHz > kMaxInputsPerSecond ? 2 * tickHz : kMaxInputsPerSecond;
}

// Seconds. A connection must say hello within the first. A client or server that is silent for the second counts as
// gone. Without a newer input the last one holds for the third, or two and a half times as long on a link that delays
// inputs so, then the player stands still.
inline constexpr double kHelloTimeout = 3;
inline constexpr double kSilenceTimeout = 8;
inline constexpr double kInputHold = 0.1;

// Seconds that a client waits for the first answer. ENet repeats its request twice in three seconds, and the server its
// answer: over 1 s of delay and 25 % loss each way a handshake fails once in 10,000. Within 5 s it failed once in 40.
inline constexpr double kConnectTimeout = 8;

// While a client joins, hello and welcome may each take several tries, one in one and a half round trips, and neither
// inputs nor snapshots show meanwhile that the far end is there. So until then both ends wait this many round trips
// longer than kHelloTimeout and kSilenceTimeout: five or six tries, which at 25 % loss all fail once in 1,000 to 4,000.
// A round trip counts for kMaxJoinRoundTrip, seconds, at most, whatever the link claims.
inline constexpr double kJoinRoundTrips = 8;
inline constexpr double kMaxJoinRoundTrip = 3;
// The seconds by which both ends wait longer while a client joins. roundTrip: of the link, seconds.
[[nodiscard]] constexpr double FindJoinPatience(double roundTrip) {
  return kJoinRoundTrips * (roundTrip < kMaxJoinRoundTrip ? roundTrip : kMaxJoinRoundTrip);
}

// Bad messages from one client within a second, counted from the first one, before it is disconnected.
inline constexpr unsigned kMaxBadMessagesPerSecond = 20;

}  // namespace wobble::protocol
