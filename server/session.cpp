// Every message goes through one parser (protocol::ParseClientMessage) that checks bytes, fields and ranges. The code
// here checks what depends on the session: state, channel, order and rate.
#include "server/session.h"

#include <algorithm>
#include <cmath>

#include "server/names.h"

namespace wobble::server {
namespace {

using protocol::wire::GoodbyeReason;

// The most new stalls that one input may report: all bodies at once, after a link was dead for a while. A larger number
// is not credible.
constexpr std::uint32_t kMostStallsAtOnce = protocol::kMaxBodies;

MessageEffect Drop(Session& session, DropReason reason, double now,
                   protocol::ParseResult parsed = protocol::ParseResult::kOk) {
  session.badMessages.Roll(now);
  // Three kinds are not held against the client: a server that stood still finds honest inputs ahead of its own tick, a
  // quick player may send more commands than are taken, and nobody knows at once that another scene has begun.
  const bool isHonest =
      reason == DropReason::kFutureInput || reason == DropReason::kTooMany || reason == DropReason::kOldScene;
  if (!isHonest) ++session.badMessages.count;
  MessageEffect effect;
  effect.dropped = reason;
  effect.parsed = parsed;
  return effect;
}

MessageEffect Refuse(GoodbyeReason reason, std::string detail) {
  MessageEffect effect;
  effect.kind = MessageEffect::Kind::kRefuse;
  effect.reason = reason;
  effect.detail = std::move(detail);
  return effect;
}

MessageEffect TakeHello(Session& session, const protocol::wire::Hello& hello, double now) {
  if (session.state != Session::State::kAwaitingHello) return Drop(session, DropReason::kOutOfOrder, now);
  if (hello.protocol_version() != protocol::kProtocolVersion) {
    return Refuse(GoodbyeReason::WrongVersion, "server speaks version " + std::to_string(protocol::kProtocolVersion) +
                                                   ", client " + std::to_string(hello.protocol_version()));
  }
  if (hello.schema_hash() != protocol::kSchemaHash) {
    return Refuse(GoodbyeReason::WrongSchema, "client was built from another messages.fbs");
  }
  const auto& given = session.admission.name;
  const std::string_view name(given.data(), std::find(given.begin(), given.end(), '\0'));
  if (!session.ComesAlong()) session.name = CleanName(name.empty() ? hello.name()->string_view() : name);
  if (hello.kept() != nullptr) session.kept.assign(hello.kept()->begin(), hello.kept()->end());
  session.spectator =
      hello.role() == protocol::wire::Role::Spectator || session.admission.rank == transport::Rank::kWatcher;
  session.isBot = hello.bot();
  MessageEffect effect;
  effect.kind = MessageEffect::Kind::kJoin;
  return effect;
}

// Takes the hand of an input unless a newer input was taken before: inputs may overtake one another.
void TakeHand(Session& session, const protocol::wire::Input& input) {
  const std::uint32_t tick = input.frames()->Get(0)->tick();
  if (tick < session.handTick) return;
  session.handTick = tick;
  session.hand.reset();
  const protocol::wire::Hand* hand = input.hand();
  if (hand == nullptr || hand->grip() == 0) return;
  const protocol::wire::Vec3& target = hand->target();
  session.hand = HandCommand{.body = hand->body(),
                             .vertex = hand->vertex(),
                             .grip = hand->grip(),
                             .target = {target.x(), target.y(), target.z()}};
}

MessageEffect TakeInput(Session& session, const protocol::wire::Input& input, std::uint32_t currentTick, double now) {
  if (session.ComesAlong()) return Drop(session, DropReason::kOldScene, now);
  if (session.state != Session::State::kPlaying) return Drop(session, DropReason::kOutOfOrder, now);
  if (!session.inputsTaken.Take(now, session.maxInputs)) return Drop(session, DropReason::kTooMany, now);
  for (const protocol::wire::InputFrame* frame : *input.frames()) {
    if (!InputBuffer::IsNear(*frame, currentTick)) return Drop(session, DropReason::kFutureInput, now);
  }
  if (!session.download.TakeReport(input.downloaded())) return Drop(session, DropReason::kBadAcknowledgement, now);
  protocol::SentWindow::Report report;
  if (!session.subscription.TakeAcknowledgement(input.acked_sequence(), input.acked_history(), now, report)) {
    return Drop(session, DropReason::kBadAcknowledgement, now);
  }
  if (report.roundTrip >= 0) session.roundTrip = report.roundTrip;
  for (const protocol::wire::InputFrame* frame : *input.frames()) session.inputs.Add(*frame, currentTick);
  // A hand of the scene before would hold whatever has its body's number now.
  if (session.download.IsOfThisScene(input.downloaded())) TakeHand(session, input);
  session.hasSentInput = true;
  MessageEffect effect;
  if (input.stalls() > session.stalls) {
    effect.stalls = std::min<std::uint32_t>(input.stalls() - session.stalls, kMostStallsAtOnce);
    session.stalls = input.stalls();
  }
  return effect;
}

physics::Vector3d ToVector(const protocol::wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }

ShoveCommand MakeCommand(const protocol::wire::Push& push) {
  return {.body = push.body(), .vertex = push.vertex(), .direction = ToVector(*push.direction())};
}

CutCommand MakeCommand(const protocol::wire::Cut& cut) {
  return {.body = cut.body(), .eye = ToVector(*cut.eye()), .from = ToVector(*cut.from()), .to = ToVector(*cut.to())};
}

TuneCommand MakeCommand(const protocol::wire::Tune& tune) {
  using Kind = TuneCommand::Kind;
  static constexpr Kind kKinds[] = {Kind::kGravity, Kind::kStiffness, Kind::kTimeRate, Kind::kJump};
  return {kKinds[static_cast<std::size_t>(tune.kind())], ToVector(*tune.value())};
}

BuildCommand MakeCommand(const protocol::wire::Build& build) {
  using Kind = BuildCommand::Kind;
  static constexpr Kind kKinds[] = {Kind::kAddParticle, Kind::kAddSpring,      Kind::kSetParticle,
                                    Kind::kSetSpring,   Kind::kRemoveParticle, Kind::kRemoveSpring};
  return {.kind = kKinds[static_cast<std::size_t>(build.kind())],
          .a = build.a(),
          .b = build.b(),
          .at = ToVector(*build.at()),
          .mass = double{build.mass()},
          .fixed = build.fixed(),
          .stiffness = double{build.stiffness()},
          .damping = double{build.damping()},
          .restLength = double{build.rest_length()}};
}

// The command in a message; nullopt for messages of other kinds.
std::optional<Command> FindCommand(const protocol::wire::ClientMessage& message) {
  if (const auto* push = message.body_as_Push()) return MakeCommand(*push);
  if (const auto* cut = message.body_as_Cut()) return MakeCommand(*cut);
  if (const auto* inspect = message.body_as_Inspect()) return InspectCommand{inspect->body()};
  if (const auto* tune = message.body_as_Tune()) return MakeCommand(*tune);
  if (const auto* build = message.body_as_Build()) return MakeCommand(*build);
  if (const auto* order = message.body_as_Order()) return OrderCommand{order->line()->str()};
  if (const auto* say = message.body_as_Say()) return TalkCommand{SayCommand{say->text()->str()}};
  if (const auto* emote = message.body_as_Emote()) {
    return TalkCommand{EmoteCommand{static_cast<std::uint8_t>(emote->kind())}};
  }
  if (const auto* rename = message.body_as_Rename()) return TalkCommand{RenameCommand{rename->name()->str()}};
  return {};
}

MessageEffect TakeCommand(Session& session, Command&& command, double now) {
  if (session.ComesAlong()) return Drop(session, DropReason::kOldScene, now);
  if (session.state != Session::State::kPlaying) return Drop(session, DropReason::kOutOfOrder, now);
  if (!session.commands.Take(now, protocol::kMaxCommandsPerSecond)) return Drop(session, DropReason::kTooMany, now);
  MessageEffect effect;
  effect.kind = MessageEffect::Kind::kCommand;
  effect.command = std::move(command);
  return effect;
}

}  // namespace

MessageEffect TakeMessage(Session& session, transport::Channel channel, std::span<const std::uint8_t> bytes,
                          std::uint32_t currentTick, double now) {
  session.lastHeard = now;
  const protocol::wire::ClientMessage* message = nullptr;
  const protocol::ParseResult parsed = protocol::ParseClientMessage(bytes, message);
  if (parsed != protocol::ParseResult::kOk) return Drop(session, DropReason::kParse, now, parsed);

  const bool isInput = message->body_as_Input() != nullptr;
  if (channel != (isInput ? transport::Channel::kInput : transport::Channel::kControl)) {
    return Drop(session, DropReason::kWrongChannel, now);
  }
  if (isInput) return TakeInput(session, *message->body_as_Input(), currentTick, now);
  if (const auto* hello = message->body_as_Hello()) return TakeHello(session, *hello, now);
  if (auto command = FindCommand(*message)) return TakeCommand(session, std::move(*command), now);
  MessageEffect effect;
  effect.kind = MessageEffect::Kind::kLeave;
  effect.reason = message->body_as_Goodbye()->reason();
  return effect;
}

void AwaitHelloAgain(Session& session, double now) {
  session.state = Session::State::kAwaitingHello;
  session.awaitsSince = now;
  session.hasSentInput = false;
  session.body = 0;
  session.hand.reset();
  session.inspected = 0;
  session.subscription.ForgetScene();
}

std::optional<GoodbyeReason> FindTimeout(const Session& session, double now) {
  if (session.state == Session::State::kEnding) return {};
  if (session.badMessages.count > protocol::kMaxBadMessagesPerSecond) return GoodbyeReason::BadMessages;
  const double overdrawn = std::max(session.commands.OverdrawnFor(), session.inputsTaken.OverdrawnFor());
  if (overdrawn >= protocol::kMaxOverdrawnSeconds) return GoodbyeReason::TooMuch;
  const double patience = session.hasSentInput ? 0 : session.joinPatience;
  if (session.state == Session::State::kAwaitingHello &&
      now - session.awaitsSince > protocol::kHelloTimeout + patience) {
    return GoodbyeReason::NoHello;
  }
  if (now - session.lastHeard > protocol::kSilenceTimeout + patience) return GoodbyeReason::Silent;
  return {};
}

physics::Control TakeControl(Session& session, std::uint32_t tick, std::uint32_t holdTicks) {
  const protocol::wire::InputFrame frame = session.inputs.Take(tick, holdTicks);
  physics::Control control;
  control.moveX = frame.move_x() / 127.0;
  control.moveY = frame.move_y() / 127.0;
  const double length = std::hypot(control.moveX, control.moveY);
  if (length > 1) {  // two keys at once move no faster than one
    control.moveX /= length;
    control.moveY /= length;
  }
  control.jump = (frame.buttons() & 1) != 0;
  control.puff = (frame.buttons() & 2) != 0;
  control.stiffen = (frame.buttons() & 4) != 0;
  return control;
}

const char* Name(DropReason reason) {
  switch (reason) {
    case DropReason::kParse:
      return "not a valid message";
    case DropReason::kOutOfOrder:
      return "out of order";
    case DropReason::kWrongChannel:
      return "on the wrong channel";
    case DropReason::kFutureInput:
      return "input too far ahead";
    case DropReason::kBadAcknowledgement:
      return "acknowledges what was never sent";
    case DropReason::kTooMany:
      return "too many in a second";
    case DropReason::kOldScene:
      return "of the scene before";
  }
  return "unknown";
}

}  // namespace wobble::server
