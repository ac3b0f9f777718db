// Held keys go through HeldKeys and become the player's input; all others act at once, and again with each repetition.
// Letters have the same meaning with and without Shift or Caps Lock. The keys are also documented in command.cpp
// (--help) and status.cpp (the list on the screen).
#include "client/terminal/controls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace wobble::terminal {
namespace {

constexpr float kTurnStep = 0.09F;  // rad per key event
constexpr float kZoomStep = 1.12F;

struct Binding {
  char32_t key;
  Action action;
};
constexpr std::array<Binding, 12> kBindings{{{U'w', Action::kForward},
                                             {kKeyUp, Action::kForward},
                                             {U's', Action::kBack},
                                             {kKeyDown, Action::kBack},
                                             {U'a', Action::kLeft},
                                             {kKeyLeft, Action::kLeft},
                                             {U'd', Action::kRight},
                                             {kKeyRight, Action::kRight},
                                             {U' ', Action::kJump},
                                             {U'e', Action::kPuff},
                                             {U'p', Action::kPuff},
                                             {U'f', Action::kStiffen}}};

}  // namespace

bool Controls::TakePause() { return std::exchange(m_pause, false); }

std::vector<char32_t> Controls::TakeOthers() { return std::exchange(m_others, {}); }

void Controls::Take(const KeyEvent& event, double now, bool hasBody, Camera& camera) {
  const char32_t key = event.key >= U'A' && event.key <= U'Z' ? event.key - U'A' + U'a' : event.key;
  const auto binding =
      std::find_if(kBindings.begin(), kBindings.end(), [key](const Binding& each) { return each.key == key; });
  if (binding != kBindings.end()) {
    if (event.released) {
      m_held.Release(binding->action);
    } else {
      m_held.Press(binding->action, now);
    }
    return;
  }
  if (!event.released) TakeCommand(key, hasBody, camera);
}

void Controls::TakeCommand(char32_t key, bool hasBody, Camera& camera) {
  constexpr char32_t kControlC = 3, kControlZ = 26;
  switch (key) {
    case U'q':
    case kKeyEscape:
    case kControlC:
      m_quit = true;
      return;
    case kControlZ:
      m_pause = true;
      return;
    case kReleasesReported:
      return m_held.TrustReleases();
    case U'x':
      return m_held.ReleaseAll();
    case U'c':
      return camera.ChooseNextMode(hasBody);
    case U'j':
    case U'[':
      return camera.Turn(kTurnStep);
    case U'l':
    case U']':
      return camera.Turn(-kTurnStep);
    case U'i':
      return camera.Tilt(-kTurnStep / 2);
    case U'k':
      return camera.Tilt(kTurnStep / 2);
    case U'+':
    case U'=':
      return camera.Zoom(1 / kZoomStep);
    case U'-':
      return camera.Zoom(kZoomStep);
    case U'?':
    case U'h':
      m_showsKeys = !m_showsKeys;
      return;
    default:
      m_others.push_back(key);
  }
}

client::Input Controls::MakeInput(double now, const Camera& camera) const {
  const auto held = [&](Action action) { return m_held.IsHeld(action, now) ? 1.0F : 0.0F; };
  const float right = held(Action::kRight) - held(Action::kLeft);
  const float forward = held(Action::kForward) - held(Action::kBack);
  const float length = std::max(1.0F, std::hypot(right, forward));
  const Direction move = camera.ToWorld(right / length, forward / length);
  client::Input input;
  input.moveX = std::clamp(move.x, -1.0F, 1.0F);
  input.moveY = std::clamp(move.y, -1.0F, 1.0F);
  input.jump = held(Action::kJump) > 0;
  input.puff = held(Action::kPuff) > 0;
  input.stiffen = held(Action::kStiffen) > 0;
  return input;
}

}  // namespace wobble::terminal
