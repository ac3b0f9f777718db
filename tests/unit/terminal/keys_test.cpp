// The keyboard: bytes to key events, and key events to held keys.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "client/terminal/colour.h"
#include "client/terminal/controls.h"
#include "client/terminal/held_keys.h"
#include "client/terminal/keys.h"

namespace wobble::terminal {
namespace {

// Notation: "+w" pressed, "-w" released; arrows are U D L R after '^'.
std::string Describe(const std::vector<KeyEvent>& events) {
  std::string text;
  for (const KeyEvent& event : events) {
    if (!text.empty()) text += ' ';
    text += event.released ? '-' : '+';
    switch (event.key) {
      case kKeyUp:
        text += "^U";
        break;
      case kKeyDown:
        text += "^D";
        break;
      case kKeyLeft:
        text += "^L";
        break;
      case kKeyRight:
        text += "^R";
        break;
      case kKeyEscape:
        text += "esc";
        break;
      case kKeyBackspace:
        text += "back";
        break;
      case kReleasesReported:
        text += "releases";
        break;
      default:
        text += event.key < 0x20 ? "C-" + std::string(1, static_cast<char>(event.key + '@'))
                                 : std::string(1, static_cast<char>(event.key));
    }
  }
  return text;
}

// Feeds all bytes at once, then waits a second.
std::string Decode(const std::string& bytes) {
  KeyDecoder decoder;
  std::vector<KeyEvent> events;
  decoder.Feed(bytes, 0, events);
  decoder.Expire(1, events);
  return Describe(events);
}

struct Case {
  std::string bytes;
  std::string keys;
};

const std::vector<Case> kCases{
    {"w", "+w"},
    {"wA ?", "+w +A +  +?"},
    {"\x03\x1a", "+C-C +C-Z"},
    {"\033[A\033[B\033[C\033[D", "+^U +^D +^R +^L"},
    {"\033OA\033OD", "+^U +^L"},
    {"\033[1;2A", "+^U"},  // with Shift
    {"\033[1;3A", ""},     // with Alt
    {"\033", "+esc"},
    {"\033\033", "+esc +esc"},
    {"\033w", ""},       // Alt-w
    {"\033[5~w", "+w"},  // page up
    {"\033[200~w", "+w"},
    {"\033[<0;3;4Mw", "+w"},  // mouse
    {"\033OPw", "+w"},        // F1
    {"\033[?15u", "+releases"},
    {"\033[?1u", ""},  // knows the protocol, but does not report releases
    {"\033[?0u", ""},
    {"\033[119u\033[119;1:2u\033[119;1:3u", "+w +w -w"},
    {"\033[119;;119u", "+w"},
    {"\033[97:65;2u", "+A"},
    {"\033[47:63;2:1u", "+?"},
    {"\033[1094::119u", "+w"},  // a Cyrillic key in the place of w
    {"\033[1094u", ""},
    {"\033[99;5u", "+C-C"},
    {"\033[122;5:1u", "+C-Z"},
    {"\033[27u", "+esc"},
    {"\033[27;1:3u", "-esc"},
    {"\033[1;1:3A", "-^U"},
    {"\033[119;3u", ""},    // Alt
    {"\033[57441;2u", ""},  // Shift alone
    {"\033[99999999999u", ""},
    {"\033[;;;;u", ""},
    {"\033[119u\xc3\xa4w\x7f", "+w +w +back"},
    {"\033[127u", "+back"},
    {"\033[1\x03w", "+C-C +w"},
    {"\033[1;\033[Bw", "+^D +w"},
};

TEST(TerminalKeys, DecodesEachSequence) {
  for (const Case& each : kCases) {
    EXPECT_EQ(Decode(each.bytes), each.keys) << testing::PrintToString(each.bytes);
  }
}

TEST(TerminalKeys, SequencesMayBeSplitAnywhere) {
  for (const Case& each : kCases) {
    KeyDecoder decoder;
    std::vector<KeyEvent> events;
    double now = 0;
    for (const char byte : each.bytes) decoder.Feed(std::string(1, byte), now += 0.01, events);
    decoder.Expire(now + 1, events);
    EXPECT_EQ(Describe(events), each.keys) << testing::PrintToString(each.bytes);
  }
}

TEST(TerminalKeys, EscapeAloneIsAKeyOnlyAfterAWhile) {
  KeyDecoder decoder;
  std::vector<KeyEvent> events;
  decoder.Feed("\033", 10, events);
  decoder.Expire(10 + kEscapeTimeout / 2, events);
  EXPECT_TRUE(events.empty());
  decoder.Feed("[A", 10 + kEscapeTimeout / 2, events);
  EXPECT_EQ(Describe(events), "+^U");
  decoder.Feed("\033", 11, events);
  decoder.Feed("[A", 11 + 2 * kEscapeTimeout, events);
  EXPECT_EQ(Describe(events), "+^U +esc +[ +A");
}

TEST(TerminalKeys, AnEndlessSequenceIsForgotten) {
  EXPECT_EQ(Decode("\033[" + std::string(100'000, '1') + "Aw"), "+w");
}

TEST(TerminalKeys, OutlivesGarbage) {
  std::mt19937 random(4);
  KeyDecoder decoder;
  std::vector<KeyEvent> events;
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes;
    for (auto left = random() % 12; left > 0; --left) {
      bytes += random() % 3 == 0 ? "\033[;:?u19A"[random() % 10] : static_cast<char>(random());
    }
    decoder.Feed(bytes, i * 0.1, events);
    for (const KeyEvent& event : events) ASSERT_TRUE(event.key < 0x7F || event.key > 0x10FFFF) << "in round " << i;
    events.clear();
  }
  decoder.Feed("\030w", 1e6, events);  // CAN ends any sequence
  ASSERT_FALSE(events.empty());
  EXPECT_TRUE(events.back().key == U'w');
}

TEST(TerminalHeldKeys, ATapIsAStep) {
  HeldKeys held;
  held.Press(Action::kForward, 10);
  EXPECT_TRUE(held.IsHeld(Action::kForward, 10));
  EXPECT_TRUE(held.IsHeld(Action::kForward, 10 + kFirstHold - 0.01));
  EXPECT_FALSE(held.IsHeld(Action::kForward, 10 + kFirstHold));
  EXPECT_FALSE(held.IsHeld(Action::kBack, 10));
}

// A keyboard that repeats after 450 ms, 30 times a second: the key is held without a gap, and ends soon after the last
// repetition.
TEST(TerminalHeldKeys, ARepeatingKeyIsHeldWithoutAGap) {
  HeldKeys held;
  double last = 0;
  for (double now = 0; now < 3; now += 0.001) {
    const bool pressed = now == 0 || (now >= 0.45 && now - last >= 1.0 / 30);
    if (pressed) held.Press(Action::kLeft, last = now);
    ASSERT_TRUE(held.IsHeld(Action::kLeft, now)) << "at " << now;
  }
  EXPECT_FALSE(held.IsHeld(Action::kLeft, last + kRepeatHold + 0.001));
}

TEST(TerminalHeldKeys, TheOppositeKeyAndStopEndIt) {
  HeldKeys held;
  held.Press(Action::kForward, 0);
  held.Press(Action::kBack, 0.1);
  EXPECT_FALSE(held.IsHeld(Action::kForward, 0.1));
  EXPECT_TRUE(held.IsHeld(Action::kBack, 0.1));
  held.Press(Action::kJump, 0.1);
  held.ReleaseAll();
  EXPECT_FALSE(held.IsHeld(Action::kBack, 0.1));
  EXPECT_FALSE(held.IsHeld(Action::kJump, 0.1));
}

// A jump while walking: the keyboard stops repeating the walking key, which is still down.
TEST(TerminalHeldKeys, AnotherKeyLetsTheFirstGoOn) {
  HeldKeys held;
  held.Press(Action::kForward, 0);
  for (int i = 0; i < 20; ++i) held.Press(Action::kForward, 0.5 + i * 0.03);
  const double jump = 1.1;
  held.Press(Action::kJump, jump);
  EXPECT_TRUE(held.IsHeld(Action::kForward, jump + kFirstHold - 0.01));
  EXPECT_FALSE(held.IsHeld(Action::kForward, jump + kFirstHold + 0.01));
  held.Press(Action::kLeft, 5);
  EXPECT_FALSE(held.IsHeld(Action::kForward, 5)) << "what is over stays over";
}

TEST(TerminalHeldKeys, ReleasesAreTrustedWhereTheyAreReported) {
  HeldKeys held;
  held.TrustReleases();
  held.Press(Action::kForward, 0);
  held.Press(Action::kRight, 1);
  held.Press(Action::kLeft, 2);
  EXPECT_TRUE(held.IsHeld(Action::kForward, 1000));
  EXPECT_TRUE(held.IsHeld(Action::kRight, 1000)) << "both are down, which the player will notice";
  held.Release(Action::kForward);
  EXPECT_FALSE(held.IsHeld(Action::kForward, 2));
}

TEST(TerminalControls, KeysBecomeInputAsTheCameraSeesIt) {
  Controls controls;
  Camera camera(CameraMode::kFollow);
  const Vector3 own{0, 0, 1};
  const auto settle = [&] {
    for (int i = 0; i < 100; ++i) camera.Update(0.03, own, std::span(&own, 1));
  };
  settle();
  const Direction forward = camera.ToWorld(0, 1), right = camera.ToWorld(1, 0);
  controls.Take({U'W'}, 10, true, camera);
  client::Input input = controls.MakeInput(10, camera);
  EXPECT_NEAR(input.moveX, forward.x, 1e-5F);
  EXPECT_NEAR(input.moveY, forward.y, 1e-5F);
  EXPECT_FALSE(input.jump || input.puff || input.stiffen);
  controls.Take({kKeyRight}, 10, true, camera);
  for (const char32_t key : {U' ', U'e', U'f'}) controls.Take({key}, 10, true, camera);
  input = controls.MakeInput(10, camera);
  EXPECT_NEAR(input.moveX, (forward.x + right.x) / std::sqrt(2.0F), 1e-5F) << "no faster diagonally";
  EXPECT_NEAR(input.moveY, (forward.y + right.y) / std::sqrt(2.0F), 1e-5F);
  EXPECT_TRUE(input.jump && input.puff && input.stiffen);
  controls.Take({U'x'}, 10, true, camera);
  input = controls.MakeInput(10, camera);
  EXPECT_EQ(std::hypot(input.moveX, input.moveY), 0);
  EXPECT_FALSE(input.jump || input.puff || input.stiffen);

  // After a turn to the left, forward is the former left.
  for (int i = 0; i < 100; ++i) controls.Take({U'j'}, 11, true, camera);
  settle();
  controls.Take({U'w'}, 20, true, camera);
  input = controls.MakeInput(20, camera);
  const float turned = std::atan2(input.moveY, input.moveX) - std::atan2(forward.y, forward.x);
  EXPECT_NEAR(std::remainder(turned - 100 * 0.09F, 6.2831853F), 0, 0.01F);
}

TEST(TerminalControls, ReleasesEndWhatTheyReleaseAndNothingElse) {
  Controls controls;
  Camera camera(CameraMode::kFollow);
  controls.Take({kReleasesReported}, 0, true, camera);
  controls.Take({U'w'}, 1, true, camera);
  controls.Take({U'w', true}, 2, true, camera);
  controls.Take({U'q', true}, 2, true, camera);
  controls.Take({U'?', true}, 2, true, camera);
  EXPECT_EQ(controls.MakeInput(2, camera).moveX, 0);
  EXPECT_FALSE(controls.IsQuitAsked());
  EXPECT_FALSE(controls.ShowsKeys());
}

TEST(TerminalControls, CommandsActAtOnce) {
  Controls controls;
  Camera camera(CameraMode::kFollow);
  controls.Take({U'c'}, 0, false, camera);
  EXPECT_EQ(camera.Mode(), CameraMode::kCircle);
  EXPECT_FALSE(controls.TakePause());
  controls.Take({26}, 0, true, camera);
  EXPECT_TRUE(controls.TakePause());
  EXPECT_FALSE(controls.TakePause());
  controls.Take({U'?'}, 0, true, camera);
  EXPECT_TRUE(controls.ShowsKeys());
  for (const char32_t key : {char32_t{U'Q'}, kKeyEscape, char32_t{3}}) {
    Controls quitting;
    quitting.Take({key}, 0, true, camera);
    EXPECT_TRUE(quitting.IsQuitAsked());
  }
}

TEST(TerminalColour, PlayersAreToldApart) {
  for (std::uint32_t body = 1; body < 200; ++body) {
    const Colour colour = Show(FindPlayerColour(body));
    const auto distance = [&](Colour other) {
      return std::abs(colour.red - other.red) + std::abs(colour.green - other.green) +
             std::abs(colour.blue - other.blue);
    };
    EXPECT_GT(distance(Show(kOwnColour)), 90) << body;
    EXPECT_GT(distance(Show(FindPlayerColour(body + 1))), 60) << body;
    EXPECT_EQ(colour, Show(FindPlayerColour(body))) << "always the same";
  }
}

}  // namespace
}  // namespace wobble::terminal
