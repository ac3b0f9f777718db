// The part of the server that outlives its process: the state that is kept, and the seats of players who are to come
// back after it.
#include <spdlog/spdlog.h>

#include <algorithm>

#include "server/server.h"

namespace wobble::server {

using protocol::wire::EventKind;

namespace {

// A connection that has said nothing for so long is dead if its player comes again, s: clients send every tick.
constexpr double kDeadAfter = 1;

bool IsKnown(const recording::Identity& identity) { return identity != recording::Identity{}; }

}  // namespace

void Server::KeepState(std::unique_ptr<recording::Checkpoints> checkpoints) {
  m_checkpoints = std::move(checkpoints);
  SaveState();
}

void Server::SaveState() {
  if (m_checkpoints == nullptr || m_isClosing) return;
  recording::Checkpoint checkpoint{.number = 0,
                                   .ground = m_stage->playground.Capture(),
                                   .nextClient = m_nextClientId,
                                   .seats = m_emptySeats,
                                   .scene = m_scene};
  for (const auto& [connection, session] : m_sessions) {
    if (session.body != 0) checkpoint.seats[session.clientId] = session.admission.identity;
  }
  m_checkpoints->Save(std::move(checkpoint));
}

std::string Server::Resume(const recording::Checkpoint& checkpoint, double now) {
  if (!m_rotation.empty()) BeginWith(checkpoint.scene);
  std::string error = m_stage->playground.Restore(checkpoint.ground);
  if (!error.empty()) return error;
  m_seatsUntil = now + kSeatPatience;
  std::vector<ClientId> gone;
  for (const auto& [client, player] : m_stage->playground.Players()) {
    m_nextClientId = std::max(m_nextClientId, client + 1);
    const auto seat = checkpoint.seats.find(client);
    const bool mayComeBack = player.body != 0 && seat != checkpoint.seats.end() && IsKnown(seat->second);
    if (mayComeBack) m_emptySeats.insert(*seat);
    if (!mayComeBack) gone.push_back(client);
  }
  m_nextClientId = std::max(m_nextClientId, checkpoint.nextClient);
  for (const ClientId client : gone) m_stage->playground.Take(LeaveEntry{client});
  for (const auto& [client, identity] : m_emptySeats) {
    m_stage->playground.Take(MoveEntry{.client = client, .control = {}, .hand = {}});
  }
  m_shownTick = World().Tick();
  m_stage->store.FollowStep(m_shownTick);
  PublishBlueprints();
  spdlog::info("tick {}: the world goes on; {} players may come back to their bodies", m_shownTick,
               m_emptySeats.size());
  return {};
}

bool Server::TakeSeat(Session& session) {
  const recording::Identity& identity = session.admission.identity;
  if (session.spectator || !IsKnown(identity)) return false;
  const auto seat = std::ranges::find_if(m_emptySeats, [&](const auto& each) { return each.second == identity; });
  if (seat != m_emptySeats.end()) {
    session.clientId = seat->first;
    m_emptySeats.erase(seat);
  } else {
    const auto isDead = [&](const auto& entry) {
      const Session& other = entry.second;
      return other.body != 0 && other.admission.identity == identity &&
             session.lastHeard - other.lastHeard > kDeadAfter;
    };
    const auto dead = std::ranges::find_if(m_sessions, isDead);
    if (m_checkpoints == nullptr || dead == m_sessions.end()) return false;
    Session& other = dead->second;
    session.clientId = other.clientId;
    other.clientId = 0;
    other.body = 0;
    other.state = Session::State::kEnding;
    m_transport->Disconnect(other.connection);
  }
  session.name = m_stage->playground.FindPlayer(session.clientId)->name;
  return true;
}

void Server::ClearSeats(double now) {
  if (m_emptySeats.empty() || now < m_seatsUntil) return;
  for (const auto& [client, identity] : m_emptySeats) {
    const Playground::Player player = *m_stage->playground.FindPlayer(client);
    m_stage->playground.Take(LeaveEntry{client});
    Broadcast(protocol::MakeEvent(EventKind::Leave, m_shownTick, client, player.body, player.name));
    Broadcast(protocol::MakeEvent(EventKind::BodyRemoved, m_shownTick, 0, player.body, ""));
    spdlog::info("client {} ({}) has not come back", client, player.name);
  }
  m_emptySeats.clear();
}

}  // namespace wobble::server
