// One client's connection, from its first byte to its goodbye.
//
// Here what a client says becomes what the world does: the one place where the protocol's types become the engine's on
// the way in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "protocol/messages.h"
#include "protocol/transport/transport.h"
#include "server/input_buffer.h"
#include "server/physics/world.h"
#include "server/play/command.h"
#include "server/snapshots/snapshot_sender.h"

namespace wobble::server {

// Why a message was dropped, beside what the parser says.
enum class DropReason : std::uint8_t {
  kParse,         // ParseResult other than kOk
  kOutOfOrder,    // an input before the hello, a second hello
  kWrongChannel,  // a message on a channel that is not its own
  kFutureInput,   // too far ahead
  kBadAcknowledgement,
  kTooMany,  // commands within a second
};
inline constexpr std::size_t kDropReasonCount = 6;
[[nodiscard]] const char* Name(DropReason reason);

struct Session {
  enum class State { kAwaitingHello, kPlaying, kEnding };
  transport::ConnectionId connection = 0;
  State state = State::kAwaitingHello;
  double connectedAt = 0;
  double lastHeard = 0;
  double joinPatience = 0;  // granted beyond both timeouts until the first input has come, s
  bool hasSentInput = false;
  ClientId clientId = 0;  // from 1
  std::string name;
  bool spectator = false;
  physics::BodyId body = 0;  // 0: none
  InputBuffer inputs;
  std::optional<HandCommand> hand;  // as of the newest input
  std::uint32_t handTick = 0;       // that input's stamp
  physics::BodyId inspected = 0;    // 0: none
  double commandWindowBegin = 0;
  unsigned commandsInWindow = 0;
  Subscription subscription;
  double roundTrip = 0;      // newest measured, s
  std::uint32_t stalls = 0;  // that it has told of
  double badWindowBegin = 0;
  unsigned badInWindow = 0;
};

// What a message asks the server to do beyond the session.
struct MessageEffect {
  enum class Kind { kNone, kJoin, kRefuse, kLeave, kCommand };
  Kind kind = Kind::kNone;
  protocol::wire::GoodbyeReason reason{};  // of a refusal or a leave
  std::string detail;
  std::optional<DropReason> dropped;
  protocol::ParseResult parsed = protocol::ParseResult::kOk;
  std::optional<Command> command;  // of kCommand
  std::uint32_t stalls = 0;        // that the client tells of for the first time
};

// Takes one message of any bytes. currentTick: the world's. Never throws, never asserts on what is in the message.
[[nodiscard]] MessageEffect TakeMessage(Session& session, transport::Channel channel,
                                        std::span<const std::uint8_t> bytes, std::uint32_t currentTick, double now);

// A reason to end the session now: silent, or no hello in time, or too many bad messages.
[[nodiscard]] std::optional<protocol::wire::GoodbyeReason> FindTimeout(const Session& session, double now);

// What the player's body is asked to do at `tick`.
[[nodiscard]] physics::Control TakeControl(Session& session, std::uint32_t tick, std::uint32_t holdTicks);

}  // namespace wobble::server
