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
  static constexpr EventKind kKinds[] = {EventKind::Fall, EventKind::Respawn, EventKind::Goal, EventKind::Crown};
  for (const Happening& happening : m_stage->playground.TakeHappenings()) {
    m_counts.respawns += happening.kind == Happening::Kind::kRespawn ? 1 : 0;
    Broadcast(protocol::MakeEvent(kKinds[static_cast<std::size_t>(happening.kind)], m_shownTick, happening.by,
                                  happening.body, ""));
  }
}

void Server::TellStandings() {
  const Game* game = m_stage->playground.ReadGame();
  if (game == nullptr) return;
  const bool isSecond = m_shownTick % static_cast<std::uint32_t>(m_config.tickHz) == 0;
  if (isSecond || game->ReadMatch().Revision() != m_sentStandings) SendStandings();
}

bool Server::HasPlayedAllRounds() const {
  const Game* game = m_stage->playground.ReadGame();
  return game != nullptr && m_config.rounds > 0 && game->ReadMatch().Read().matches > 0;
}

bool Server::IsMatchOver() const { return m_config.afterMatch == AfterMatch::kEnd && HasPlayedAllRounds(); }

void Server::SetRounds() {
  const Game* game = m_stage->playground.ReadGame();
  const bool isDue = game != nullptr && m_config.rounds > 0 && game->ReadMatch().Read().rounds != m_config.rounds;
  if (isDue) m_stage->playground.Take(MatchEntry{m_config.rounds});
}

std::string Server::SetReady(ClientId client, bool isReady) {
  const Game* game = m_stage->playground.ReadGame();
  if (game == nullptr || m_film != nullptr) return "there is no game to be ready for";
  if (game->ReadMatch().Find(client) == nullptr) return "players say that they are ready; you watch";
  if (game->ReadMatch().ReadPhase() != Match::Phase::kLobby) return "the match has begun already";
  m_stage->playground.Take(ReadyEntry{client, isReady});
  return "";
}

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
  using protocol::wire::GamePhase;
  static constexpr GamePhase kPhases[] = {GamePhase::Lobby,  GamePhase::KickOff, GamePhase::Playing,
                                          GamePhase::Golden, GamePhase::Won,     GamePhase::Over};
  const auto narrow = [](int count) { return static_cast<std::uint16_t>(std::clamp(count, 0, 65535)); };
  const Game& game = *m_stage->playground.ReadGame();
  const Match& match = game.ReadMatch();
  m_sentStandings = match.Revision();
  protocol::ScoreboardFields board;
  board.phase = kPhases[static_cast<std::size_t>(match.ReadPhase())];
  board.round = narrow(match.Round());
  board.secondsLeft = static_cast<std::uint16_t>(std::max(0.0, match.SecondsLeft()));
  board.pointsToWin = narrow(m_stage->playground.Scene().game.pointsToWin);
  board.winner = match.Winner();
  board.rounds = narrow(match.Read().rounds);
  board.winningSide = static_cast<std::uint8_t>(match.WinningSide());
  board.object = game.Object();
  board.bearer = game.Bearer();
  for (const Match::Standing& each : match.Standings()) {
    board.scores.emplace_back(each.client, narrow(each.points), narrow(each.rounds));
    board.seats.emplace_back(static_cast<std::uint8_t>(each.side), each.isReady, each.isBot);
  }
  if (m_stage->playground.Scene().game.HasSides()) {
    for (const Match::Side& side : match.Read().sides)
      board.sides.emplace_back(narrow(side.points), narrow(side.rounds));
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
