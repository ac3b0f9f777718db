// The part of the server that admits, welcomes and dismisses clients, from the first byte of a connection to its
// goodbye.
#include <spdlog/spdlog.h>

#include <algorithm>

#include "protocol/text.h"
#include "server/server.h"

namespace wobble::server {

using protocol::wire::EventKind;
using protocol::wire::GoodbyeReason;
using transport::Channel;

void Server::TakeEvent(const transport::Event& event, double now) {
  using Kind = transport::Event::Kind;
  if (event.kind == Kind::kConnected) {
    Session& session = m_sessions[event.connection];
    session.connection = event.connection;
    session.connectedAt = session.awaitsSince = session.lastHeard = now;
    session.joinPatience = protocol::FindJoinPatience(m_transport->ReadRoundTrip(event.connection));
    if (event.admission != nullptr) session.admission = *event.admission;
    session.maxInputs = protocol::FindMaxInputs(static_cast<unsigned>(m_config.tickHz));
    if (m_isClosing) End(session, GoodbyeReason::ServerClosing, "");
    return;
  }
  const auto found = m_sessions.find(event.connection);
  if (found == m_sessions.end()) return;
  Session& session = found->second;
  if (event.kind == Kind::kDisconnected) {
    ForgetPlayer(session, session.IsIn());
    m_sessions.erase(found);
    return;
  }
  if (session.state == Session::State::kEnding) return;
  if (event.kind == Kind::kOffence) return End(session, GoodbyeReason::TooMuch, "");

  const MessageEffect effect = TakeMessage(session, event.channel, event.bytes, m_shownTick, now);
  m_counts.stalls += effect.stalls;
  if (effect.dropped) {
    ++m_counts.dropped[static_cast<std::size_t>(*effect.dropped)];
    ++m_counts.parse[static_cast<std::size_t>(effect.parsed)];
    spdlog::debug("client {}: message dropped, {} ({})", session.clientId, Name(*effect.dropped), Name(effect.parsed));
  }
  switch (effect.kind) {
    case MessageEffect::Kind::kNone:
      break;
    case MessageEffect::Kind::kJoin:
      Join(session);
      break;
    case MessageEffect::Kind::kRefuse:
      End(session, effect.reason, effect.detail);
      break;
    case MessageEffect::Kind::kLeave:
      spdlog::info("client {} ({}) left", session.clientId, session.name);
      ForgetPlayer(session, false);
      session.state = Session::State::kEnding;
      m_transport->Disconnect(session.connection);
      break;
    case MessageEffect::Kind::kCommand:
      Obey(session, *effect.command, now);
      break;
  }
}

bool Server::LetIn(Session& session) {
  if (CountPlaying() >= static_cast<std::size_t>(m_config.maxClients)) {
    End(session, GoodbyeReason::ServerFull,
        std::to_string(m_config.maxClients) + " of " + std::to_string(m_config.maxClients) + " players are in");
    return false;
  }
  if (IsBusy()) {
    End(session, GoodbyeReason::Busy, "the machine has no time for more players; try again later");
    return false;
  }
  if (m_isLocked && session.admission.rank < transport::Rank::kModerator) {
    End(session, GoodbyeReason::ServerFull, std::string(protocol::kLockedDetail));
    return false;
  }
  session.name = FindFreeName(session, session.name);
  return true;
}

void Server::Join(Session& session) {
  const bool comesAlong = session.ComesAlong();
  if (!comesAlong && !LetIn(session)) return;
  PublishBlueprints();  // to the others; the newcomer gets all blueprints after its welcome
  const bool isBack = !comesAlong && TakeSeat(session);
  session.state = Session::State::kPlaying;
  if (session.clientId == 0) session.clientId = m_nextClientId++;
  if (m_film != nullptr) {
    session.spectator = true;
  } else {
    if (!isBack) {
      m_stage->playground.Take(JoinEntry{session.clientId, session.spectator, session.name, session.isBot});
    }
    session.body = m_stage->playground.FindPlayer(session.clientId)->body;
  }
  if (!comesAlong) ++m_counts.joins;
  m_counts.clientsPeak = std::max(m_counts.clientsPeak, CountPlaying());
  spdlog::info("client {} ({}) {}{}", session.clientId, session.name,
               comesAlong ? "came along"
               : isBack   ? "is back"
                          : "joined",
               session.spectator ? " as spectator" : "");
  SendWelcome(session);
  Broadcast(protocol::MakeEvent(EventKind::Join, m_shownTick, session.clientId, session.body, session.name));
  SendTuning();
  if (!comesAlong) RecallMute(session, session.lastHeard);
  if (m_film != nullptr && !m_film->ReadRecording().Fault().empty()) {
    Notify(session, fmt::format("this recording is damaged: shown up to {:.1f} s", m_film->End()));
  }
}

void Server::SendWelcome(Session& session) {
  protocol::WelcomeFields fields;
  fields.clientId = session.clientId;
  fields.ownBody = session.body;
  fields.tick = m_shownTick;
  fields.tickHz = static_cast<std::uint16_t>(m_config.tickHz);
  fields.snapshotHz = static_cast<std::uint16_t>(m_config.snapshotHz);
  fields.scene = m_stage->playground.Scene().name;
  fields.blueprintCount = static_cast<std::uint16_t>(m_stage->store.Blueprints().All().size());
  fields.obstacles = CaptureObstacles(World().Obstacles());
  for (const CapturedGround& ground : m_stage->grounds) fields.heightFields.push_back(ground.field);
  fields.hands = CaptureHands(m_stage->playground.Scene());
  fields.reach = static_cast<float>(m_stage->playground.Scene().hands.reach);
  fields.game = m_film != nullptr ? kFilm : scenes::NameOf(m_stage->playground.Scene().game.kind);
  fields.workshop = m_stage->playground.ReadWorkshop() != nullptr ? m_stage->playground.ReadWorkshop()->Body() : 0;
  fields.rank = static_cast<protocol::wire::Rank>(session.admission.rank);
  fields.description = protocol::MakeLine(m_stage->playground.Scene().description, protocol::kMaxDescriptionBytes);
  fields.talk = FindTalk(session);
  fields.ownBlueprint = static_cast<std::uint8_t>(m_stage->playground.Scene().player.blueprint);
  if (session.body != 0) fields.drive = CaptureDrive(m_stage->playground.Scene());
  const auto send = [&](const protocol::Message& message) {
    if (m_transport->Send(session.connection, Channel::kControl, message) != transport::SendResult::kQueued) {
      spdlog::warn("client {}: could not be welcomed", session.clientId);
    }
  };
  send(protocol::MakeWelcome(fields));
  // The players who have joined before, so that every body has its name.
  for (const auto& [connection, other] : m_sessions) {
    if (other.state != Session::State::kPlaying || &other == &session) continue;
    send(protocol::MakeEvent(EventKind::Join, m_shownTick, other.clientId, other.body, other.name));
  }
  for (const auto& [client, told] : m_filmPlayers) {
    send(protocol::MakeEvent(EventKind::Join, m_shownTick, client, told.first, told.second));
  }
  session.download.Begin(m_stage->grounds.size(), m_stage->store.Blueprints().All().size(), fields.ownBlueprint,
                         session.kept);
  session.kept = {};
}

void Server::SendDownloads() {
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying || session.download.IsDone()) continue;
    session.download.SendDue(m_stage->grounds, m_stage->store.Blueprints(),
                             [&](const protocol::Message& message) { SendTo(session, message); });
  }
}

void Server::End(Session& session, GoodbyeReason reason, const std::string& detail) {
  const std::string who = session.clientId != 0 ? fmt::format("client {} ({})", session.clientId, session.name)
                                                : fmt::format("connection {}", session.connection);
  spdlog::info("{} is sent away: {}", who, protocol::DescribeGoodbye(reason, detail));
  if (!session.IsIn()) ++m_counts.refusals;
  ++m_counts.goodbyes[static_cast<std::size_t>(reason)];
  ForgetPlayer(session, session.IsIn() && !m_isClosing);
  session.state = Session::State::kEnding;
  const protocol::Message goodbye = protocol::MakeServerGoodbye(reason, detail);
  if (m_transport->Send(session.connection, Channel::kControl, goodbye) != transport::SendResult::kQueued) {
    spdlog::debug("client {}: gone before its goodbye", session.clientId);
  }
  m_transport->Disconnect(session.connection);
}

void Server::ForgetPlayer(Session& session, bool isLost) {
  if (!session.IsIn()) return;
  const bool isBetweenScenes = session.ComesAlong();
  session.state = Session::State::kEnding;
  ++(isLost ? m_counts.disconnects : m_counts.leaves);
  if (isLost) spdlog::info("client {} ({}) was lost", session.clientId, session.name);
  if (isBetweenScenes) return;
  if (m_film == nullptr) m_stage->playground.Take(LeaveEntry{session.clientId});
  if (m_film == nullptr && m_stage->playground.Players().empty()) {
    m_clock.SetRate(1);
    BeginAnew();
  }
  Broadcast(protocol::MakeEvent(EventKind::Leave, m_shownTick, session.clientId, session.body, session.name));
  if (session.body != 0) Broadcast(protocol::MakeEvent(EventKind::BodyRemoved, m_shownTick, 0, session.body, ""));
  session.body = 0;
  SendTuning();
}

void Server::BeginAnew() {
  // Not while the server closes: its summary is of the world that was played.
  if (!m_config.resetsWhenEmpty || m_isClosing || CountPlaying() > 0) return;
  if (m_rotation.empty()) return RestartWorld();
  if (const std::string refusal = GoToNextScene(); !refusal.empty()) spdlog::debug("{}", refusal);
}

void Server::EndTimedOut(double now) {
  for (auto& [connection, session] : m_sessions) {
    if (const auto reason = FindTimeout(session, now)) End(session, *reason, "");
  }
}

void Server::Broadcast(const protocol::Message& message) {
  for (const auto& [connection, session] : m_sessions) {
    if (session.state == Session::State::kPlaying) SendTo(session, message);
  }
}

void Server::SendTo(const Session& session, const protocol::Message& message) {
  if (m_transport->Send(session.connection, Channel::kControl, message) != transport::SendResult::kQueued) {
    spdlog::debug("client {}: a message could not be sent", session.clientId);
  }
}

void Server::Close(const std::string& why, double now) {
  SaveState();
  m_isClosing = true;
  m_lastTicks.clear();
  Receive(now);
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kEnding) End(session, GoodbyeReason::ServerClosing, why);
  }
  m_transport->Flush();
}

void Server::ListPlaying(std::vector<ClientId>& clients) const {
  clients.clear();
  for (const auto& [connection, session] : m_sessions) {
    if (session.IsIn()) clients.push_back(session.clientId);
  }
}

bool Server::IsBusy() const { return m_load.Level() >= LoadLevel::kBusy && !m_config.admitsWhenBusy; }

bool Server::AcceptsJoins() const {
  return !m_isClosing && !IsMatchOver() && !IsBusy() && CountPlaying() < static_cast<std::size_t>(m_config.maxClients);
}

ClientCounts Server::CountClients() const {
  ClientCounts counts;
  for (const auto& [connection, session] : m_sessions) {
    switch (session.state) {
      case Session::State::kAwaitingHello:
        if (!session.ComesAlong()) {
          ++counts.joining;
          break;
        }
        [[fallthrough]];
      case Session::State::kPlaying:
        ++(session.spectator ? counts.watching : counts.playing);
        break;
      case Session::State::kEnding:
        ++counts.leaving;
        break;
    }
  }
  return counts;
}

std::size_t Server::CountPlaying() const {
  return static_cast<std::size_t>(
      std::count_if(m_sessions.begin(), m_sessions.end(), [](const auto& entry) { return entry.second.IsIn(); }));
}

}  // namespace wobble::server
