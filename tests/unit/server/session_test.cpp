// A session: every message in every state, timeouts, and the control that an input becomes.
#include "server/session.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wobble::server {
namespace {

using protocol::ParseResult;
using protocol::wire::GoodbyeReason;
using protocol::wire::InputFrame;
using protocol::wire::Role;
using transport::Channel;
using Kind = MessageEffect::Kind;
using SessionState = Session::State;

protocol::Message Hello() { return protocol::MakeHello("Ada", Role::Player); }
protocol::Message Input(std::uint32_t tick, std::int8_t x = 0, std::int8_t y = 0, std::uint8_t buttons = 0) {
  const InputFrame frame(tick, x, y, buttons);
  return protocol::MakeInput({.frames = {&frame, 1}});
}
protocol::Message Goodbye() { return protocol::MakeClientGoodbye(GoodbyeReason::Left, "bye"); }
protocol::Message Garbage() { return {1, 2, 3, 4, 5, 6, 7, 8, 9}; }

Session MakeSession(SessionState state) {
  Session session;
  session.connection = 7;
  session.state = state;
  session.connectedAt = session.awaitsSince = session.lastHeard = 10;
  return session;
}

struct Case {
  const char* name;
  protocol::Message message;
  Channel channel;
  // Expected in kAwaitingHello, kPlaying and kEnding.
  std::array<Kind, 3> kinds;
  std::array<std::optional<DropReason>, 3> dropped;
};

TEST(Session, EveryMessageInEveryState) {
  constexpr auto kNothing = std::optional<DropReason>{};
  const auto all = [](DropReason reason) { return std::array<std::optional<DropReason>, 3>{reason, reason, reason}; };
  constexpr std::array<Kind, 3> kNone{Kind::kNone, Kind::kNone, Kind::kNone};
  const std::vector<Case> cases{
      {"hello",
       Hello(),
       Channel::kControl,
       {Kind::kJoin, Kind::kNone, Kind::kNone},
       {kNothing, DropReason::kOutOfOrder, DropReason::kOutOfOrder}},
      {"hello on input", Hello(), Channel::kInput, kNone, all(DropReason::kWrongChannel)},
      {"hello on snapshot", Hello(), Channel::kSnapshot, kNone, all(DropReason::kWrongChannel)},
      {"input", Input(100), Channel::kInput, kNone, {DropReason::kOutOfOrder, kNothing, DropReason::kOutOfOrder}},
      {"input on control", Input(100), Channel::kControl, kNone, all(DropReason::kWrongChannel)},
      {"input on snapshot", Input(100), Channel::kSnapshot, kNone, all(DropReason::kWrongChannel)},
      {"future input",
       Input(100 + protocol::kMaxInputLeadTicks + 1),
       Channel::kInput,
       kNone,
       {DropReason::kOutOfOrder, DropReason::kFutureInput, DropReason::kOutOfOrder}},
      {"goodbye", Goodbye(), Channel::kControl, {Kind::kLeave, Kind::kLeave, Kind::kLeave}, {}},
      {"goodbye on input", Goodbye(), Channel::kInput, kNone, all(DropReason::kWrongChannel)},
      {"garbage", Garbage(), Channel::kControl, kNone, all(DropReason::kParse)},
      {"garbage on input", Garbage(), Channel::kInput, kNone, all(DropReason::kParse)},
      {"nothing", {}, Channel::kControl, kNone, all(DropReason::kParse)},
  };
  const std::array<SessionState, 3> states{SessionState::kAwaitingHello, SessionState::kPlaying, SessionState::kEnding};
  for (const Case& each : cases) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      SCOPED_TRACE(std::string(each.name) + " in state " + std::to_string(i));
      Session session = MakeSession(states[i]);
      const MessageEffect effect = TakeMessage(session, each.channel, each.message, 100, 11);
      EXPECT_EQ(effect.kind, each.kinds[i]);
      EXPECT_EQ(effect.dropped, each.dropped[i]);
      EXPECT_EQ(effect.parsed != ParseResult::kOk, effect.dropped == DropReason::kParse);
      EXPECT_EQ(session.badMessages.count, effect.dropped && effect.dropped != DropReason::kFutureInput ? 1U : 0U);
      EXPECT_EQ(session.lastHeard, 11);
      EXPECT_EQ(session.state, states[i]);  // only the server changes states
    }
  }
}

TEST(Session, HelloSaysWhoItIs) {
  Session session = MakeSession(SessionState::kAwaitingHello);
  const auto hello = protocol::MakeHello("Eve\x1b[2J\n", Role::Spectator);
  EXPECT_EQ(TakeMessage(session, Channel::kControl, hello, 0, 10).kind, Kind::kJoin);
  EXPECT_TRUE(session.spectator);
  EXPECT_EQ(session.name, "Eve [2J");  // names_test.cpp has the rest

  Session nameless = MakeSession(SessionState::kAwaitingHello);
  EXPECT_EQ(TakeMessage(nameless, Channel::kControl, protocol::MakeHello("", Role::Player), 0, 10).kind, Kind::kJoin);
  EXPECT_FALSE(nameless.name.empty());
  EXPECT_FALSE(nameless.spectator);
}

TEST(Session, AnotherVersionOrSchemaIsRefusedWithBothNumbers) {
  Session session = MakeSession(SessionState::kAwaitingHello);
  const auto other = static_cast<std::uint16_t>(protocol::kProtocolVersion + 1);
  MessageEffect effect =
      TakeMessage(session, Channel::kControl, protocol::MakeHello("a", Role::Player, {}, other), 0, 10);
  EXPECT_EQ(effect.kind, Kind::kRefuse);
  EXPECT_EQ(effect.reason, GoodbyeReason::WrongVersion);
  EXPECT_NE(effect.detail.find(std::to_string(other)), std::string::npos);
  EXPECT_NE(effect.detail.find(std::to_string(protocol::kProtocolVersion)), std::string::npos);

  const auto schema = protocol::MakeHello("a", Role::Player, {}, protocol::kProtocolVersion, protocol::kSchemaHash ^ 1);
  effect = TakeMessage(session, Channel::kControl, schema, 0, 10);
  EXPECT_EQ(effect.kind, Kind::kRefuse);
  EXPECT_EQ(effect.reason, GoodbyeReason::WrongSchema);
}

TEST(Session, AnAcknowledgementOfWhatWasNeverSentIsDroppedWithItsInput) {
  Session session = MakeSession(SessionState::kPlaying);
  session.subscription.sent.RecordSent(10);
  const InputFrame frame(101, 50, 0, 0);
  const auto effect = TakeMessage(session, Channel::kInput,
                                  protocol::MakeInput({.frames = {&frame, 1}, .ackedSequence = 2}), 100, 10.1);
  EXPECT_EQ(effect.dropped, DropReason::kBadAcknowledgement);
  EXPECT_EQ(TakeControl(session, 101, 6).moveX, 0);

  EXPECT_FALSE(TakeMessage(session, Channel::kInput, protocol::MakeInput({.frames = {&frame, 1}, .ackedSequence = 1}),
                           100, 10.25)
                   .dropped);
  EXPECT_NEAR(session.roundTrip, 0.25, 1e-12);
  EXPECT_GT(TakeControl(session, 101, 6).moveX, 0);
}

TEST(Session, OneFutureFrameDropsTheWholeMessage) {
  Session session = MakeSession(SessionState::kPlaying);
  const std::array<InputFrame, 2> frames{InputFrame(1000, 1, 0, 0), InputFrame(101, 50, 0, 0)};
  EXPECT_EQ(TakeMessage(session, Channel::kInput, protocol::MakeInput({.frames = frames}), 100, 10).dropped,
            DropReason::kFutureInput);
  EXPECT_EQ(TakeControl(session, 101, 6).moveX, 0);
}

// After a server has stood still for seconds, the inputs of that time are ahead of its tick.
TEST(Session, InputsAheadOfAServerThatPausedAreNotHeldAgainstHim) {
  Session session = MakeSession(SessionState::kPlaying);
  for (std::uint32_t i = 0; i < 150; ++i) {
    const InputFrame frame(300 + i, 1, 0, 0);
    EXPECT_EQ(
        TakeMessage(session, Channel::kInput, protocol::MakeInput({.frames = {&frame, 1}}), 100, 20 + i * 0.01).dropped,
        DropReason::kFutureInput);
  }
  EXPECT_FALSE(FindTimeout(session, 22));
}

TEST(Session, AFloodOfGarbageEndsIt) {
  Session session = MakeSession(SessionState::kPlaying);
  for (unsigned i = 0; i < protocol::kMaxBadMessagesPerSecond; ++i) {
    (void)TakeMessage(session, Channel::kInput, Garbage(), 0, 20 + 0.01 * i);
    EXPECT_FALSE(FindTimeout(session, 20 + 0.01 * i)) << i;
  }
  (void)TakeMessage(session, Channel::kInput, Garbage(), 0, 20.5);
  EXPECT_EQ(FindTimeout(session, 20.5), GoodbyeReason::BadMessages);
}

TEST(Session, NowAndThenAMistakeIsForgiven) {
  Session session = MakeSession(SessionState::kPlaying);
  for (int i = 0; i < 600; ++i) {  // ten a second for a minute
    const double now = 20 + 0.1 * i;
    (void)TakeMessage(session, Channel::kInput, Garbage(), 0, now);
    ASSERT_FALSE(FindTimeout(session, now));
  }
}

// An input a tick is what a client sends. After a link that was dead for a while many come at once.
TEST(Session, MoreInputsThanATickHasAreDroppedAndWhoGoesOnIsSentAway) {
  const auto send = [](Session& session, double begin, double seconds, int aSecond) {
    int dropped = 0;
    for (int i = 0; i < static_cast<int>(seconds * aSecond); ++i) {
      const double now = begin + static_cast<double>(i) / aSecond;
      protocol::wire::InputFrame frame(static_cast<std::uint32_t>(i + 1), 0, 0, 0);
      const auto message = protocol::MakeInput({.frames = {&frame, 1}});
      dropped += TakeMessage(session, Channel::kInput, message, static_cast<std::uint32_t>(i + 1), now).dropped ? 1 : 0;
    }
    return dropped;
  };
  Session honest = MakeSession(SessionState::kPlaying);
  EXPECT_EQ(send(honest, 10, 20, 60), 0);
  EXPECT_GT(send(honest, 40, 0.5, 800), 200) << "what a blackout had held back";
  EXPECT_EQ(send(honest, 42, 5, 60), 0);
  EXPECT_GT(send(honest, 50, 0.5, 800), 200);
  EXPECT_EQ(send(honest, 52, 5, 60), 0);
  EXPECT_GT(send(honest, 60, 0.5, 800), 200);
  EXPECT_FALSE(FindTimeout(honest, 61)) << "three times, not in a row";
  Session flooder = MakeSession(SessionState::kPlaying);
  EXPECT_GT(send(flooder, 10, 3.5, 1000), 2500);
  EXPECT_EQ(FindTimeout(flooder, 13.5), protocol::wire::GoodbyeReason::TooMuch);
}

// The client takes the first byte of another scene before it plays there: what says no more is of the scene before.
TEST(Session, AHandOfTheSceneBeforeHoldsNothing) {
  Session session = MakeSession(SessionState::kPlaying);
  session.clientId = 1;
  session.download.Begin(0, 0, 0, {});
  const protocol::wire::Hand hand({1, 2, 3}, 4, 5, 6);
  const auto reach = [&](std::uint32_t tick) {
    const protocol::wire::InputFrame frame(tick, 0, 0, 0);
    const auto message = protocol::MakeInput({.frames = {&frame, 1}, .hand = &hand, .downloaded = 0});
    return TakeMessage(session, Channel::kInput, message, tick, 12);
  };
  EXPECT_FALSE(reach(5).dropped);
  EXPECT_FALSE(session.hand) << "nothing is taken yet, so it does not play";
  AwaitHelloAgain(session, 12);
  EXPECT_EQ(reach(6).dropped, DropReason::kOldScene);
  EXPECT_EQ(session.badMessages.count, 0U);
  EXPECT_FALSE(FindTimeout(session, 15));
  EXPECT_EQ(FindTimeout(session, 15.01), GoodbyeReason::NoHello);
}

TEST(Session, NoHelloForThreeSecondsEndsItWhateverElseIsSaid) {
  Session session = MakeSession(SessionState::kAwaitingHello);
  (void)TakeMessage(session, Channel::kControl, Garbage(), 0, 12.5);
  EXPECT_FALSE(FindTimeout(session, 13));
  EXPECT_EQ(FindTimeout(session, 13.01), GoodbyeReason::NoHello);
  session.state = SessionState::kPlaying;
  EXPECT_FALSE(FindTimeout(session, 13.01));
}

TEST(Session, EightSecondsOfSilenceEndIt) {
  Session session = MakeSession(SessionState::kPlaying);
  (void)TakeMessage(session, Channel::kInput, Input(5), 5, 30);
  EXPECT_FALSE(FindTimeout(session, 38));
  EXPECT_EQ(FindTimeout(session, 38.01), GoodbyeReason::Silent);
  session.state = SessionState::kEnding;
  EXPECT_FALSE(FindTimeout(session, 100));
}

TEST(Session, ASlowLinkGetsMoreTimeUntilItsFirstInput) {
  Session session = MakeSession(SessionState::kAwaitingHello);
  session.joinPatience = 4;
  EXPECT_FALSE(FindTimeout(session, 17));
  EXPECT_EQ(FindTimeout(session, 17.01), GoodbyeReason::NoHello);
  session.state = SessionState::kPlaying;
  session.lastHeard = 17;
  EXPECT_FALSE(FindTimeout(session, 29));
  EXPECT_EQ(FindTimeout(session, 29.01), GoodbyeReason::Silent);
  (void)TakeMessage(session, Channel::kInput, Input(5), 5, 29);
  EXPECT_FALSE(FindTimeout(session, 37));
  EXPECT_EQ(FindTimeout(session, 37.01), GoodbyeReason::Silent);
}

TEST(Session, ControlIsNeverLongerThanOne) {
  for (int x = -127; x <= 127; x += 2) {
    for (int y = -127; y <= 127; y += 2) {
      Session session = MakeSession(SessionState::kPlaying);
      const auto input = Input(101, static_cast<std::int8_t>(x), static_cast<std::int8_t>(y));
      ASSERT_FALSE(TakeMessage(session, Channel::kInput, input, 100, 10).dropped);
      const physics::Control control = TakeControl(session, 101, 6);
      const double length = std::hypot(control.moveX, control.moveY);
      ASSERT_LE(length, 1 + 1e-9);
      ASSERT_NEAR(length, std::min(1.0, std::hypot(x, y) / 127), 1e-9);
      ASSERT_NEAR(control.moveX * y, control.moveY * x, 1e-9);  // the direction is kept
    }
  }
}

TEST(Session, ButtonsBecomeWhatTheyAreCalled) {
  for (std::uint8_t buttons = 0; buttons < 8; ++buttons) {
    Session session = MakeSession(SessionState::kPlaying);
    ASSERT_FALSE(TakeMessage(session, Channel::kInput, Input(101, 0, 0, buttons), 100, 10).dropped);
    const physics::Control control = TakeControl(session, 101, 6);
    EXPECT_EQ(control.jump, (buttons & 1) != 0);
    EXPECT_EQ(control.puff, (buttons & 2) != 0);
    EXPECT_EQ(control.stiffen, (buttons & 4) != 0);
  }
}

TEST(Session, EveryReasonHasAName) {
  for (std::size_t i = 0; i < kDropReasonCount; ++i) EXPECT_STRNE(Name(static_cast<DropReason>(i)), "unknown");
}

}  // namespace
}  // namespace wobble::server
