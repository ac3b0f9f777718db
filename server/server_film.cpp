// The part of the server that shows a recording. Whoever comes in watches the players of then; what they order goes to
// the film (server/admin).
#include <spdlog/spdlog.h>

#include "server/server.h"

namespace wobble::server {

using protocol::wire::EventKind;

namespace {

// Numbers of watchers, beyond those of the players of then.
constexpr ClientId kFirstWatcher = 1U << 30;

}  // namespace

std::string Server::Show(std::unique_ptr<recording::Film> film) {
  std::string error = film->Begin(m_stage->playground);
  if (!error.empty()) return error;
  m_film = std::move(film);
  m_nextClientId = kFirstWatcher;
  m_stage->store.FollowStep(m_shownTick);
  PublishBlueprints();
  TellFilmPlayers();
  return {};
}

void Server::ShowFilm() {
  const bool hasMoved = m_film->Advance();
  if (const std::string fault = m_film->TakeFault(); !fault.empty()) {
    spdlog::warn("the recording cannot be shown there: {}", fault);
  }
  m_stage->store.FollowStep(m_shownTick);
  if (m_film->IsGathering()) return;
  TellHappenings();
  TellStandings();
  if (hasMoved) TellFilmPlayers();
}

// Whoever is in now and was not, and the other way round: they came and went, or the film has jumped.
void Server::TellFilmPlayers() {
  std::map<ClientId, std::pair<physics::BodyId, std::string>> present;
  for (const auto& [client, player] : m_stage->playground.Players()) present[client] = {player.body, player.name};
  for (const auto& [client, told] : m_filmPlayers) {
    const auto& [body, name] = told;
    const auto now = present.find(client);
    if (now != present.end() && now->second == told) continue;
    Broadcast(protocol::MakeEvent(EventKind::Leave, m_shownTick, client, body, name));
    if (body != 0) Broadcast(protocol::MakeEvent(EventKind::BodyRemoved, m_shownTick, 0, body, ""));
  }
  for (const auto& [client, told] : present) {
    const auto before = m_filmPlayers.find(client);
    if (before != m_filmPlayers.end() && before->second == told) continue;
    Broadcast(protocol::MakeEvent(EventKind::Join, m_shownTick, client, told.first, told.second));
  }
  m_filmPlayers = std::move(present);
}

}  // namespace wobble::server
