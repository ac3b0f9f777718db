// The part of the server that lets players act beyond moving: hands, tuning, the workshop and the game. The rules of
// each stand in a file of server/play; this one hands them what players send, and tells clients what came of it.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>

#include "server/server.h"

namespace wobble::server {

using protocol::wire::EventKind;

namespace {

// Rate at which inspected forces are sent, 1/s: people read them by eye.
constexpr int kForcesHz = 10;

constexpr const char* kOnlyWatched = "this is a recording: it can be watched, and wound with film orders";

template <class... Each>
struct Visitor : Each... {
  using Each::operator()...;
};

}  // namespace

void Server::Obey(Session& session, const Command& command, double now) {
  if (const auto* talk = std::get_if<TalkCommand>(&command)) return TakeTalk(session, *talk, now);
  const bool isHarmless =
      std::holds_alternative<InspectCommand>(command) || std::holds_alternative<OrderCommand>(command);
  if (m_film != nullptr && !isHarmless) return Notify(session, kOnlyWatched);
  if (session.isMuted && !isHarmless) return Notify(session, kMuted);
  const ActEntry act{.client = session.clientId,
                     .isHost = session.admission.rank == transport::Rank::kOwner,
                     .mayChangeAll = session.admission.rank >= transport::Rank::kModerator,
                     .command = {}};
  const auto take = [&](const auto& each) {
    ActEntry entry = act;
    entry.command = each;
    return m_stage->playground.Take(entry);
  };
  const std::string refusal = std::visit(Visitor{
                                             [&](const InspectCommand& inspect) {
                                               session.inspected = inspect.body;
                                               return std::string();
                                             },
                                             [&](const OrderCommand& order) {
                                               TakeOrder(session, order.line);
                                               return std::string();
                                             },
                                             [&](const TuneCommand& tune) { return Tune(session, tune, now); },
                                             [](const TalkCommand&) { return std::string(); },  // see above
                                             take,
                                         },
                                         command);
  if (!refusal.empty()) Notify(session, refusal);
}

std::string Server::Tune(const Session& session, const TuneCommand& command, double now) {
  const bool isHost = session.admission.rank == transport::Rank::kOwner;
  std::string error;
  if (!IsOfTime(command.kind)) {
    error = m_stage->playground.Take(ActEntry{.client = session.clientId, .isHost = isHost, .command = command});
  } else if (session.body == 0) {
    error = kSpectatorsCannotTune;
  } else if (!m_stage->playground.ReadTuning().MayTune(command.kind, isHost)) {
    error = kMayNotTune;
  } else {
    error = m_pace.Tune(command, isHost, now, m_clock);
  }
  if (error.empty()) SendTuning();
  return error;
}

void Server::TellHappenings() {
  for (const Happening& happening : m_stage->playground.TakeHappenings()) {
    const bool isFall = happening.kind == Happening::Kind::kFall;
    m_counts.respawns += isFall ? 0 : 1;
    Broadcast(protocol::MakeEvent(isFall ? EventKind::Fall : EventKind::Respawn, m_shownTick, happening.by,
                                  happening.body, ""));
  }
}

void Server::TellStandings() {
  const Sumo* game = m_stage->playground.ReadGame();
  if (game == nullptr) return;
  const bool isSecond = m_shownTick % static_cast<std::uint32_t>(m_config.tickHz) == 0;
  if (isSecond || game->Revision() != m_sentStandings) SendStandings();
}

bool Server::HasPlayedAllRounds() const {
  const Sumo* game = m_stage->playground.ReadGame();
  return game != nullptr && m_config.rounds > 0 && game->Round() > m_config.rounds;
}

bool Server::IsMatchOver() const { return m_config.afterMatch == AfterMatch::kEnd && HasPlayedAllRounds(); }

void Server::FollowMatch() {
  if (m_config.afterMatch == AfterMatch::kEnd || !HasPlayedAllRounds() || m_nextStage.valid()) return;
  if (m_config.afterMatch == AfterMatch::kRestart) {
    RestartWorld();
    Say("the match is over, and the next one begins");
  } else if (GoToNextScene().empty()) {
    Say("the match is over; the next scene is " + m_rotation[m_nextScene].scene.name);
  }
}

void Server::SendStandings() {
  const Sumo& game = *m_stage->playground.ReadGame();
  m_sentStandings = game.Revision();
  protocol::ScoreboardFields board;
  const bool isWon = game.ReadPhase() == Sumo::Phase::kWon;
  board.phase = isWon ? protocol::wire::GamePhase::Won : protocol::wire::GamePhase::Playing;
  board.round = static_cast<std::uint16_t>(game.Round());
  board.secondsLeft = static_cast<std::uint16_t>(std::max(0.0, game.SecondsLeft()));
  board.pointsToWin = static_cast<std::uint16_t>(m_stage->playground.Scene().game.pointsToWin);
  board.winner = game.Winner();
  for (const Sumo::Standing& each : game.Standings()) {
    board.scores.emplace_back(each.client, static_cast<std::uint16_t>(each.points),
                              static_cast<std::uint16_t>(each.rounds));
  }
  Broadcast(protocol::MakeScoreboard(board));
}

void Server::SendTuning() {
  for (const auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    const bool isSpectator = session.body == 0;
    SendTo(session, protocol::MakeTuning(CaptureTuning(m_stage->playground.ReadTuning(), m_clock.Rate(), isSpectator,
                                                       session.admission.rank == transport::Rank::kOwner)));
  }
}

void Server::SendForces() {
  if (m_shownTick % static_cast<std::uint32_t>(std::max(1, m_config.tickHz / kForcesHz)) >=
      static_cast<std::uint32_t>(m_config.tickHz / m_snapshotHz)) {
    return;
  }
  std::map<physics::BodyId, protocol::Message> messages;
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying || session.inspected == 0) continue;
    if (World().FindBody(session.inspected) == nullptr) {
      session.inspected = 0;
      continue;
    }
    protocol::Message& message = messages[session.inspected];
    if (message.empty()) message = CaptureForces(World(), session.inspected, m_shownTick);
    SendTo(session, message);
  }
}

void Server::Notify(const Session& session, const std::string& text) {
  SendTo(session, protocol::MakeNotice(std::string_view(text).substr(0, protocol::kMaxNoticeBytes)));
}

}  // namespace wobble::server
