#include "client/terminal/held_keys.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace wobble::terminal {
namespace {

std::optional<Action> FindOpposite(Action action) {
  switch (action) {
    case Action::kForward:
      return Action::kBack;
    case Action::kBack:
      return Action::kForward;
    case Action::kLeft:
      return Action::kRight;
    case Action::kRight:
      return Action::kLeft;
    default:
      return std::nullopt;
  }
}

}  // namespace

void HeldKeys::Press(Action action, double now) {
  if (m_releasesReported) {
    Until(action) = std::numeric_limits<double>::infinity();
    return;
  }
  if (const auto opposite = FindOpposite(action)) Release(*opposite);
  const bool repeats = IsHeld(action, now);
  // A repetition never shortens the time that the first press gave.
  Until(action) = std::max(Until(action), now + (repeats ? kRepeatHold : kFirstHold));
  if (repeats) return;
  for (double& until : m_until) {
    if (until > now) until = std::max(until, now + kFirstHold);
  }
}

void HeldKeys::Release(Action action) { Until(action) = 0; }

void HeldKeys::ReleaseAll() { m_until.fill(0); }

bool HeldKeys::IsHeld(Action action, double now) const { return now < m_until[static_cast<std::size_t>(action)]; }

}  // namespace wobble::terminal
