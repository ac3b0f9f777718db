// The part of the server that lets players act beyond moving: hands, tuning, the workshop and the game. The rules of
// each stand in a file of server/play; this one hands them the world and the players.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>

#include "server/server.h"

namespace wobble::server {

namespace {

// Rate at which inspected forces are sent, 1/s: people read them by eye.
constexpr int kForcesHz = 10;

constexpr const char* kMuted = "you may only move: a moderator has muted you";

template <class... Each>
struct Visitor : Each... {
  using Each::operator()...;
};

}  // namespace

void Server::Obey(Session& session, const Command& command, double now) {
  const bool isHarmless =
      std::holds_alternative<InspectCommand>(command) || std::holds_alternative<OrderCommand>(command);
  if (session.isMuted && !isHarmless) return Notify(session, kMuted);
  const bool isHost = session.admission.rank == transport::Rank::kOwner;
  const Workshop::Builder builder{session.clientId, session.admission.rank >= transport::Rank::kModerator};
  const Actor actor{session.clientId, session.body};
  const std::string refusal =
      std::visit(Visitor{
                     [&](const ShoveCommand& push) { return m_hands.StartShove(actor, push, m_world); },
                     [&](const CutCommand& cut) {
                       std::string error;
                       const auto blade = m_hands.FindBlade(actor, cut, m_world, error);
                       if (!blade) return error;
                       if (m_workshop && cut.body == m_workshop->Body())
                         return m_workshop->Cut(builder, *blade, m_world);
                       m_world.CutSprings(cut.body, *blade);
                       return error;
                     },
                     [&](const InspectCommand& inspect) {
                       session.inspected = inspect.body;
                       return std::string();
                     },
                     [&](const TuneCommand& tune) {
                       if (session.body == 0) return std::string("spectators cannot tune");
                       std::string error = m_tuning.Tune(tune, isHost, now, m_world, m_clock);
                       if (error.empty()) SendTuning();
                       return error;
                     },
                     [&](const BuildCommand& build) {
                       if (!m_workshop || session.body == 0)
                         return std::string("only players in a scene with a workshop can build");
                       return m_workshop->Build(builder, build, m_world);
                     },
                     [&](const OrderCommand& order) {
                       TakeOrder(session, order.line);
                       return std::string();
                     },
                 },
                 command);
  if (!refusal.empty()) Notify(session, refusal);
}

void Server::ActByHand() {
  for (const auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    m_hands.Hold({session.clientId, session.body}, session.isMuted ? std::nullopt : session.hand, m_world);
  }
  m_hands.Act(m_world);
  if (m_workshop && m_workshop->Update(m_world)) m_hands.LetGo(m_workshop->Body());
}

void Server::PlayGame() {
  if (!m_game) return;
  std::map<physics::BodyId, ClientId> players;
  for (const auto& [connection, session] : m_sessions) {
    if (session.body != 0) players[session.body] = session.clientId;
  }
  std::vector<physics::BodyId> touched;
  for (const auto& [body, client] : players) {
    m_world.ListTouching(body, touched);
    for (const physics::BodyId other : touched) {
      const auto found = players.find(other);
      if (found != players.end()) m_game->NoteTouch(client, found->second);
    }
  }
  const int round = m_game->Round();
  m_game->Advance(m_world.Settings().tickDuration);
  if (m_game->Round() != round) {
    for (const auto& [connection, session] : m_sessions) {
      if (session.body == 0) continue;
      Respawn(session.body, scenes::FindFreeSpawn(m_scene.player, session.clientId, m_world));
    }
  }
  const bool isSecond = m_world.Tick() % static_cast<std::uint32_t>(m_config.tickHz) == 0;
  if (isSecond || m_game->Revision() != m_sentStandings) SendStandings();
}

bool Server::IsMatchOver() const { return m_game && m_config.rounds > 0 && m_game->Round() > m_config.rounds; }

void Server::NoteFall(const Session& session) {
  if (!m_game) return;
  const ClientId by = m_game->NoteFall(session.clientId);
  Broadcast(protocol::MakeEvent(protocol::wire::EventKind::Fall, m_world.Tick(), by, session.body, ""));
}

void Server::SendStandings() {
  m_sentStandings = m_game->Revision();
  protocol::ScoreboardFields board;
  const bool isWon = m_game->ReadPhase() == Sumo::Phase::kWon;
  board.phase = isWon ? protocol::wire::GamePhase::Won : protocol::wire::GamePhase::Playing;
  board.round = static_cast<std::uint16_t>(m_game->Round());
  board.secondsLeft = static_cast<std::uint16_t>(std::max(0.0, m_game->SecondsLeft()));
  board.pointsToWin = static_cast<std::uint16_t>(m_scene.game.pointsToWin);
  board.winner = m_game->Winner();
  for (const Sumo::Standing& each : m_game->Standings()) {
    board.scores.emplace_back(each.client, static_cast<std::uint16_t>(each.points),
                              static_cast<std::uint16_t>(each.rounds));
  }
  Broadcast(protocol::MakeScoreboard(board));
}

void Server::SendTuning() {
  for (const auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    const bool isSpectator = session.body == 0;
    SendTo(session, protocol::MakeTuning(CaptureTuning(m_tuning, m_clock.Rate(), isSpectator,
                                                       session.admission.rank == transport::Rank::kOwner)));
  }
}

void Server::SendForces() {
  if (m_world.Tick() % static_cast<std::uint32_t>(std::max(1, m_config.tickHz / kForcesHz)) >=
      static_cast<std::uint32_t>(m_config.tickHz / m_snapshotHz)) {
    return;
  }
  std::map<physics::BodyId, protocol::Message> messages;
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying || session.inspected == 0) continue;
    if (m_world.FindBody(session.inspected) == nullptr) {
      session.inspected = 0;
      continue;
    }
    protocol::Message& message = messages[session.inspected];
    if (message.empty()) message = CaptureForces(m_world, session.inspected);
    SendTo(session, message);
  }
}

void Server::Notify(const Session& session, const std::string& text) {
  SendTo(session, protocol::MakeNotice(std::string_view(text).substr(0, protocol::kMaxNoticeBytes)));
}

}  // namespace wobble::server
