#include "server/session.h"

#include <algorithm>
#include <cmath>

namespace wobble::server {
namespace {

using protocol::wire::GoodbyeReason;

MessageEffect Drop(Session& session, DropReason reason, double now,
                   protocol::ParseResult parsed = protocol::ParseResult::kOk) {
  if (now - session.badWindowBegin > 1) {
    session.badWindowBegin = now;
    session.badInWindow = 0;
  }
  // A server that stood still finds the inputs of that time ahead of its own: nobody's fault, so not held against him.
  if (reason != DropReason::kFutureInput) ++session.badInWindow;
  MessageEffect effect;
  effect.dropped = reason;
  effect.parsed = parsed;
  return effect;
}

MessageEffect Refuse(GoodbyeReason reason, std::string detail) {
  return {MessageEffect::Kind::kRefuse, reason, std::move(detail), {}, {}};
}

// Names go to other clients and into logs: nothing that a terminal would obey.
std::string CleanName(const flatbuffers::String& name) {
  std::string clean;
  for (const char c : name.str()) {
    const auto byte = static_cast<unsigned char>(c);
    clean += byte < 0x20 || byte == 0x7F ? '?' : c;
  }
  return clean.empty() ? "player" : clean;
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
  session.name = CleanName(*hello.name());
  session.spectator = hello.role() == protocol::wire::Role::Spectator;
  return {MessageEffect::Kind::kJoin, {}, {}, {}, {}};
}

MessageEffect TakeInput(Session& session, const protocol::wire::Input& input, std::uint32_t currentTick, double now) {
  if (session.state != Session::State::kPlaying) return Drop(session, DropReason::kOutOfOrder, now);
  for (const protocol::wire::InputFrame* frame : *input.frames()) {
    if (!InputBuffer::IsNear(*frame, currentTick)) return Drop(session, DropReason::kFutureInput, now);
  }
  protocol::SentWindow::Report report;
  if (!session.subscription.TakeAcknowledgement(input.acked_sequence(), input.acked_history(), now, report)) {
    return Drop(session, DropReason::kBadAcknowledgement, now);
  }
  if (report.roundTrip >= 0) session.roundTrip = report.roundTrip;
  for (const protocol::wire::InputFrame* frame : *input.frames()) session.inputs.Push(*frame, currentTick);
  session.hasSentInput = true;
  return {};
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
  return {MessageEffect::Kind::kLeave, message->body_as_Goodbye()->reason(), {}, {}, {}};
}

std::optional<GoodbyeReason> FindTimeout(const Session& session, double now) {
  if (session.state == Session::State::kEnding) return {};
  if (session.badInWindow > protocol::kMaxBadMessagesPerSecond) return GoodbyeReason::BadMessages;
  const double patience = session.hasSentInput ? 0 : session.joinPatience;
  if (session.state == Session::State::kAwaitingHello &&
      now - session.connectedAt > protocol::kHelloTimeout + patience) {
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
  if (length > 1) {  // two keys at once are no faster than one
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
  }
  return "unknown";
}

}  // namespace wobble::server
