// The state of one client's connection, and what its messages do to it.
//
// This is the one place where the protocol's types become the engine's on the way in: input frames become controls, and
// command messages become commands (play/command.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.h"
#include "protocol/transport/admission.h"
#include "protocol/transport/transport.h"
#include "server/input_buffer.h"
#include "server/physics/world.h"
#include "server/play/command.h"
#include "server/snapshots/download.h"
#include "server/snapshots/subscription.h"

namespace wobble::server {

// Why a message was dropped.
enum class DropReason : std::uint8_t {
  kParse,               // malformed: any ParseResult but kOk
  kOutOfOrder,          // an input or command before the hello, or a second hello
  kWrongChannel,        // on another channel than its kind of message
  kFutureInput,         // an input for a tick too far ahead
  kBadAcknowledgement,  // acknowledges a packet or a download that was never sent
  kTooMany,             // more commands or inputs in a second than anybody needs
  kOldScene,            // sent before the client knew that another scene had begun
};
inline constexpr std::size_t kDropReasonCount = 7;
[[nodiscard]] const char* Name(DropReason reason);

// Counts events within a second. A window begins with the first call of Roll after the last one has passed.
struct SecondWindow {
  double begin = 0;  // s
  unsigned count = 0;

  // Starts a new window if the present one is over. Call it before `count` is raised.
  void Roll(double now) {
    if (now - begin > 1) *this = {.begin = now, .count = 0};
  }
};

// So many events a second, up to `most` at once: a second's unless said otherwise. After a pause of the server all that
// came meanwhile is there at once: most of it is dropped, and what follows at an honest rate is not.
struct Allowance {
  double left = -1;         // events; below 0: none has come yet
  double countedAt = 0;     // s
  double droppedFrom = -2;  // s, since when events were dropped, never a second without one
  double droppedAt = -2;    // s, the last one

  // False: it is one too many.
  [[nodiscard]] bool Take(double now, double perSecond) { return Take(now, perSecond, perSecond); }
  [[nodiscard]] bool Take(double now, double perSecond, double most) {
    left = left < 0 ? most : std::min(most, left + perSecond * (now - countedAt));
    countedAt = now;
    if (left >= 1) {
      --left;
      return true;
    }
    if (now - droppedAt > 1) droppedFrom = now;
    droppedAt = now;
    return false;
  }
  // For how long too many have come, s.
  [[nodiscard]] double OverdrawnFor() const { return droppedAt - droppedFrom; }
};

struct Session {
  // kAwaitingHello: connected, or taken along into another scene. -> kPlaying with a valid hello that is let in;
  //                 -> kEnding when it is refused or late.
  // kPlaying:       joined, as player or spectator. -> kEnding when it leaves, falls silent, misbehaves or is sent
  //                 away; -> kAwaitingHello when another scene begins.
  // kEnding:        the goodbye is said; messages are ignored until the transport reports the connection closed.
  enum class State { kAwaitingHello, kPlaying, kEnding };
  transport::ConnectionId connection = 0;
  State state = State::kAwaitingHello;
  // Whether it has joined and another scene has begun, for which it has not said hello yet.
  [[nodiscard]] bool ComesAlong() const { return state == State::kAwaitingHello && clientId != 0; }
  // Whether it has joined and not left.
  [[nodiscard]] bool IsIn() const { return state == State::kPlaying || ComesAlong(); }

  double connectedAt = 0;   // s
  double awaitsSince = 0;   // in kAwaitingHello, s
  double lastHeard = 0;     // s
  double joinPatience = 0;  // added to both timeouts until the first input has arrived, s
  bool hasSentInput = false;
  ClientId clientId = 0;  // from 1; 0: not joined
  std::string name;
  transport::Admission admission;
  bool isMuted = false;   // may move, and nothing else
  double mutedUntil = 0;  // s; infinite: until a moderator says otherwise
  bool spectator = false;
  bool isBot = false;
  physics::BodyId body = 0;  // 0: none
  InputBuffer inputs;
  std::optional<HandCommand> hand;  // as of the newest input
  std::uint32_t handTick = 0;       // the tick of that input
  physics::BodyId inspected = 0;    // whose forces the client is sent; 0: none
  Allowance commands;
  Allowance inputsTaken;
  Allowance talk;  // lines and emotes
  Allowance renames;
  std::string talkRefusal;                             // that the client was told last; empty: since then it was heard
  unsigned maxInputs = protocol::kMaxInputsPerSecond;  // a second
  SecondWindow badMessages;
  Subscription subscription;
  std::vector<std::uint64_t> kept;  // of the hello, until the welcome
  Download download;
  double roundTrip = 0;      // newest measured, s
  std::uint32_t stalls = 0;  // total that the client has reported
};

// The effect of a message beyond the session, left to the server.
struct MessageEffect {
  enum class Kind { kNone, kJoin, kRefuse, kLeave, kCommand };
  Kind kind = Kind::kNone;
  protocol::wire::GoodbyeReason reason{};  // of kRefuse and kLeave
  std::string detail;                      // of kRefuse
  std::optional<DropReason> dropped;
  protocol::ParseResult parsed = protocol::ParseResult::kOk;
  std::optional<Command> command;  // of kCommand
  std::uint32_t stalls = 0;        // newly reported by the client
};

// Takes one message of arbitrary bytes. currentTick: of the world. now: s. Never throws, and asserts nothing about the
// message: a bad one is dropped whole and reported in MessageEffect::dropped.
[[nodiscard]] MessageEffect TakeMessage(Session& session, transport::Channel channel,
                                        std::span<const std::uint8_t> bytes, std::uint32_t currentTick, double now);

// A client that plays is taken along into another scene: forgets what is of the present one. What counts over the whole
// connection goes on: packets, inputs, downloads and stalls.
void AwaitHelloAgain(Session& session, double now);

// The reason to end the session now: no hello in time, silence, or too many bad messages in a second. nullopt: none.
[[nodiscard]] std::optional<protocol::wire::GoodbyeReason> FindTimeout(const Session& session, double now);

// The control of the player's body at `tick`: moves in -1..1 with a length of at most 1. Without a new input the last
// one is held for holdTicks. Call it once a tick.
[[nodiscard]] physics::Control TakeControl(Session& session, std::uint32_t tick, std::uint32_t holdTicks);

}  // namespace wobble::server
