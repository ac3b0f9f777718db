// The order of the calls is chosen so that the fleet's counts stay valid in between: see the comments at each.
#include "server/ops/fleet_duty.h"

#include <algorithm>
#include <iterator>

namespace wobble::ops {
namespace {

// s. Agones gives a server up after 15 s of silence (docker/agones/fleet.yaml).
constexpr double kHealthInterval = 2;
// From the last player's leaving to the shutdown, s: time to return after a lost connection, but no long idling.
constexpr double kDesertedTime = 10;

}  // namespace

std::vector<FleetCall> FleetDuty::Follow(const FleetView& view) {
  std::vector<FleetCall> calls;
  // A server that closes calls neither health nor the players who leave: shutdown is not to wait for these, and the
  // record of players goes away with the server.
  if (!view.isClosing && view.now >= m_nextHealth) {
    calls.push_back({FleetCall::Kind::kHealth});
    m_nextHealth = view.now + kHealthInterval;
  }
  if (m_stage == Stage::kOver) return calls;
  if (view.acceptsJoins && m_stage == Stage::kStarting) {
    calls.push_back({FleetCall::Kind::kReady});
    m_stage = Stage::kReady;
  }
  // Players are counted only after ready: a ready that followed an allocate would offer a used world to others.
  if (m_stage != Stage::kStarting && !view.isClosing) CountPlayers(view.players, calls);
  if (!m_players.empty()) m_lastCompany = view.now;
  if (view.isClosing || view.isMatchOver || IsDeserted(view.now)) {
    calls.push_back({FleetCall::Kind::kShutdown});
    m_stage = Stage::kOver;
  }
  return calls;
}

void FleetDuty::CountPlayers(std::span<const std::uint32_t> players, std::vector<FleetCall>& calls) {
  m_present.assign(players.begin(), players.end());
  std::ranges::sort(m_present);
  if (m_present == m_players) return;
  if (m_stage == Stage::kReady) {
    calls.push_back({FleetCall::Kind::kAllocate});
    m_stage = Stage::kAllocated;
  }
  const auto call = [&calls](FleetCall::Kind kind, const auto& these, const auto& butNotThose) {
    std::vector<std::uint32_t> clients;
    std::ranges::set_difference(these, butNotThose, std::back_inserter(clients));
    for (const std::uint32_t client : clients) calls.push_back({kind, client});
  };
  // Players who have left go first: otherwise the count of a full server would exceed its capacity and be refused.
  call(FleetCall::Kind::kRemovePlayer, m_players, m_present);
  call(FleetCall::Kind::kAddPlayer, m_present, m_players);
  std::swap(m_players, m_present);
}

bool FleetDuty::IsDeserted(double now) const {
  return m_stage == Stage::kAllocated && m_players.empty() && now - m_lastCompany >= kDesertedTime;
}

}  // namespace wobble::ops
