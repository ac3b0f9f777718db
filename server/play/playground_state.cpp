#include "server/play/playground_state.h"

#include <algorithm>
#include <set>

namespace wobble::server {
namespace {

// Whether each player has a body of their own that there is, or none.
bool AreBodies(const std::map<ClientId, Playground::Player>& players, const physics::World& world) {
  std::set<physics::BodyId> taken;
  return std::ranges::all_of(players, [&](const auto& entry) {
    const physics::BodyId body = entry.second.body;
    return entry.first != 0 && (body == 0 || (world.FindBody(body) != nullptr && taken.insert(body).second));
  });
}

bool AreMoves(const std::map<ClientId, Playground::Player>& players) {
  return std::ranges::all_of(players, [](const auto& entry) {
    const auto& [client, player] = entry;
    return IsPossible({.client = client, .control = player.control, .hand = player.hand});
  });
}

}  // namespace

PlaygroundState Playground::Capture() const {
  PlaygroundState state{.world = m_world.Capture(),
                        .players = m_players,
                        .hands = m_hands.Read(),
                        .gravity = m_tuning.Gravity(),
                        .stiffness = m_tuning.Stiffness(),
                        .workshop = {},
                        .game = {}};
  if (m_workshop) state.workshop = m_workshop->Read();
  if (m_game) state.game = m_game->Read();
  return state;
}

std::string Playground::Restore(const PlaygroundState& state) {
  std::string error = m_world.Restore(state.world);
  if (!error.empty()) return error;
  const auto isThere = [this](const scenes::PlacedBody& placed) { return m_world.FindBody(placed.body) != nullptr; };
  if (!std::ranges::all_of(m_sceneBodies, isThere)) return "bodies: must be all that the scene places";
  if (!AreBodies(state.players, m_world)) return "players: must each have a body of the world, or none";
  if (!AreMoves(state.players)) return "players: must move by at most 1, with hands within 1e5 m";
  if (state.workshop.has_value() != m_workshop.has_value()) return "workshop: must be there if the scene has one";
  if (state.game.has_value() != m_game.has_value()) return "game: must be there if the scene has one";
  if (!state.gravity.allFinite()) return "gravity: must be finite";
  if (!m_hands.Write(state.hands, m_world)) return "hands: must hold vertices that there are";
  if (m_workshop && !m_workshop->Write(*state.workshop, m_world)) return "workshop: must be of the body in the world";
  if (m_game && !m_game->Write(*state.game)) return "game: must be of the scene's kind, with its sides and points";
  m_players = state.players;
  m_tuning.Write(state.gravity, state.stiffness);
  m_happenings.clear();
  return {};
}

}  // namespace wobble::server
