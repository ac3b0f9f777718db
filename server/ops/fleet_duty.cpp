#include "server/ops/fleet_duty.h"

#include <algorithm>

namespace wobble::ops {
namespace {

// s. Agones gives a server up after 15 s of silence (docker/agones/fleet.yaml).
constexpr double kHeartbeatInterval = 2;
// From the last player's leaving to the shutdown, s: time to return after a lost connection, but no long idling.
constexpr double kDesertedTime = 10;

}  // namespace

const FleetWish& FleetDuty::Follow(const FleetView& view) {
  using State = FleetWish::State;
  // A server that closes has no heartbeat to send, nor players to count: shutdown is not to wait for these.
  if (!view.isClosing && view.now >= m_nextHeartbeat) {
    ++m_wish.heartbeats;
    m_nextHeartbeat = view.now + kHeartbeatInterval;
  }
  if (m_wish.state == State::kShutdown) return m_wish;
  if (view.acceptsJoins && m_wish.state == State::kStarting) m_wish.state = State::kReady;
  // Players are counted only after ready: a ready that followed an allocate would offer a used world to others.
  if (m_wish.state != State::kStarting && !view.isClosing) {
    m_wish.players.assign(view.players.begin(), view.players.end());
    std::ranges::sort(m_wish.players);
    if (!m_wish.players.empty()) {
      m_wish.state = State::kAllocated;
      m_lastCompany = view.now;
    }
  }
  if (view.isClosing || view.isMatchOver || IsDeserted(view.now)) m_wish.state = State::kShutdown;
  return m_wish;
}

bool FleetDuty::IsDeserted(double now) const {
  return m_wish.state == FleetWish::State::kAllocated && m_wish.players.empty() && now - m_lastCompany >= kDesertedTime;
}

}  // namespace wobble::ops
