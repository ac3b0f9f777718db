// One tick, top to bottom: Receive, Step, Capture, Send, which has a body encoded once for all clients when the first
// of them takes it. Calls only go down; nothing but inputs and acknowledgements comes back up.
//
// Captured and encoded ahead of the choice, a thousand moving bodies were shown to nobody for the most part: the share
// of sixteen clients is a few dozen of them.
#include "server/server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cassert>

namespace wobble::server {

using protocol::wire::EventKind;
using protocol::wire::GoodbyeReason;
using transport::Channel;

namespace {

// Beyond this the wire cannot show a body any more; it starts again like one that fell, metres.
constexpr double kBorder = 0.9 * protocol::kWorldHalfExtent;

// The heights of the welcome's field of this number.
std::vector<protocol::Message> MakeRows(std::uint16_t number, const CapturedGround& ground) {
  const std::size_t columns = ground.field.columns();
  const std::size_t most = protocol::kMaxRowsHeights / columns * columns;
  const std::span<const std::uint16_t> heights = ground.heights;
  std::vector<protocol::Message> messages;
  for (std::size_t begin = 0; begin < heights.size(); begin += most) {
    const auto part = heights.subspan(begin, std::min(most, heights.size() - begin));
    messages.push_back(protocol::MakeHeightRows(number, static_cast<std::uint16_t>(begin / columns), part));
  }
  return messages;
}

std::vector<protocol::Message> MakeChunks(std::uint8_t number, const CapturedBlueprint& blueprint) {
  const std::span<const std::uint8_t> whole = blueprint.message;
  std::vector<protocol::Message> chunks;
  for (std::size_t offset = 0; offset < whole.size(); offset += protocol::kBlueprintChunkBytes) {
    const std::size_t size = std::min(protocol::kBlueprintChunkBytes, whole.size() - offset);
    chunks.push_back(protocol::MakeBlueprintChunk(number, blueprint.hash, static_cast<std::uint32_t>(whole.size()),
                                                  static_cast<std::uint32_t>(offset), whole.subspan(offset, size),
                                                  blueprint.generation));
  }
  return chunks;
}

// While the world waits for somebody, s: what their first packet may have to wait as well.
constexpr double kPausedPoll = 0.02;

// A client that loses more than this gets half its bytes: its link is full, and ENet's own throttle is off.
constexpr double kHeavyLoss = 0.1;

}  // namespace

Server::Server(const Config& config, scenes::Scene scene, std::unique_ptr<transport::Transport> transport, double now,
               std::vector<Bases> bases)
    : m_config(config),
      m_scene(std::move(scene)),
      m_transport(std::move(transport)),
      m_world(scenes::MakeWorldSettings(m_scene, 1.0 / config.tickHz, config.threads)),
      m_sceneBodies(scenes::FillWorld(m_scene, config.seed, m_world)),
      m_grounds(CaptureGrounds(m_world.Obstacles())),
      m_bases(std::move(bases)),
      m_encoder(CaptureObstacles(m_world.Obstacles())),
      m_sender(*m_transport, config.viewDistance),
      m_clock(1.0 / config.tickHz, now),
      m_hands(m_scene.hands, 1.0 / config.tickHz),
      m_tuning(m_scene.tuning, m_scene.gravity),
      m_lastCompany(now),
      m_lastCall(now) {
  assert(Validate(m_config, m_scene).empty());
  if (m_scene.workshop.isOpen) {
    const auto isWorkshop = [&](const physics::Body& body) { return body.blueprint == m_scene.workshop.blueprint; };
    m_workshop.emplace(m_scene.workshop, std::ranges::find_if(m_world.Bodies(), isWorkshop)->id, m_world);
  }
  if (m_scene.game.kind == scenes::GameRules::Kind::kSumo) m_game.emplace(m_scene.game);
  PublishBlueprints();
}

int Server::Tick(double now) {
  Receive(now);
  PauseOrGoOn(now);
  const int jumped = m_isPaused ? 0 : m_clock.TakeJumpTicks();
  for (int i = 0; i < jumped; ++i) Step();
  const int ticks = m_isPaused ? 0 : m_clock.TakeDueTicks(now);
  for (int i = 0; i < ticks; ++i) {
    Step();
    if (IsSnapshotDue()) {
      Capture();
      Send(now);
    }
  }
  m_transport->Flush();
  return jumped + ticks;
}

void Server::Receive(double now) {
  m_transport->Poll(now, [&](const transport::Event& event) { TakeEvent(event, now); });
  DropTimedOut(now);
}

void Server::PauseOrGoOn(double now) {
  if (!m_sessions.empty()) m_lastCompany = now;
  if (m_isPaused) {
    m_counts.pausedTime += now - m_lastCall;
    m_clock.StandStill(now);
  }
  m_lastCall = now;
  const bool isAlone = m_config.pauseAfter > 0 && now - m_lastCompany > m_config.pauseAfter;
  if (isAlone == m_isPaused) return;
  m_isPaused = isAlone;
  spdlog::info("tick {}: {}", m_world.Tick(), isAlone ? "nobody is here, the world waits" : "the world goes on");
}

double Server::NextCall() const { return m_isPaused ? m_lastCall + kPausedPoll : m_clock.NextTick(); }

void Server::Step() {
  ApplyInputs();
  ActByHand();
  const physics::StepReport report = m_world.Step();
  m_counts.substeps += report.substeps;
  m_counts.awakeSum += report.awake;
  m_counts.nonFinite += report.nonFinite;
  m_counts.inverted += report.inverted;
  m_counts.quarantined += report.quarantined;
  m_counts.reset += report.reset;
  m_counts.torn += report.torn;
  if (report.quarantined > 0) {
    spdlog::warn("tick {}: {} bodies stepped again in more substeps ({} not finite, {} inside out), {} of them reset",
                 m_world.Tick(), report.quarantined, report.nonFinite, report.inverted, report.reset);
  }
  RespawnFallen();
  PlayGame();
  m_captures.Follow(m_world);
}

void Server::Capture() {
  PublishBlueprints();
  m_encoder.Follow(m_captures.Bodies());
}

void Server::PublishBlueprints() {
  if (m_publishedRevision == m_world.BlueprintRevision()) return;
  m_publishedRevision = m_world.BlueprintRevision();
  const std::span<const physics::Blueprint> present = m_world.Blueprints();
  for (std::size_t slot = 0; slot < present.size(); ++slot) {
    const auto number = static_cast<std::uint8_t>(slot);
    const bool isNew = slot == m_blueprints.size();
    if (!isNew && m_blueprints[slot].revision == m_world.SlotRevision(number)) continue;
    const bool isWorkshop = m_workshop && m_world.ReadBody(m_workshop->Body()).blueprint == number;
    const BlueprintTags tags =
        isWorkshop ? CaptureTags(present[slot], m_workshop->Particles(), m_workshop->Springs()) : BlueprintTags{};
    CapturedBlueprint fresh = CaptureBlueprint(present[slot], FindBases(slot), tags);
    fresh.revision = m_world.SlotRevision(number);
    if (isNew) {
      m_blueprints.emplace_back();
    } else {
      const CapturedBlueprint& old = m_blueprints[slot];
      const bool isSame = fresh.hash == old.hash;
      fresh.generation =
          isSame ? old.generation : static_cast<std::uint8_t>((old.generation + 1) % protocol::kGenerations);
    }
    const bool isKnown = !isNew && fresh.generation == m_blueprints[slot].generation;
    m_blueprints[slot] = std::move(fresh);
    if (isKnown) continue;
    for (const protocol::Message& chunk : MakeChunks(number, m_blueprints[slot])) Broadcast(chunk);
  }
}

// A blueprint that has come up since the start has the basis of one with as many vertices on the same grid, if that is
// small: a cloth that tears, several times a second, keeps its cosines, but nobody wants 64 KB for each torn spring.
const Bases& Server::FindBases(std::size_t slot) const {
  static const Bases kNone;
  constexpr std::size_t kSmall = 8 * 1024;
  if (slot < m_bases.size()) return m_bases[slot];
  const std::span<const physics::Blueprint> present = m_world.Blueprints();
  const auto isLike = [&](const physics::Blueprint& other) {
    return other.rest == present[slot].rest && other.grid.CountVertices() == present[slot].grid.CountVertices();
  };
  for (std::size_t i = 0; i < m_bases.size(); ++i) {
    std::size_t bytes = 0;
    for (const auto& basis : m_bases[i]) bytes += basis.size();
    if (bytes <= kSmall && isLike(present[i])) return m_bases[i];
  }
  return kNone;
}

const EncodedBody& Server::Encode(std::size_t index, std::size_t quality) {
  const CapturedBody& captured = m_captures.Read(m_world, index);
  return m_encoder.Encode(index, quality, captured, m_blueprints[captured.blueprint]);
}

void Server::Send(double now) {
  const auto encode = [this](std::size_t index, std::size_t quality) -> const EncodedBody& {
    return Encode(index, quality);
  };
  const double share = m_config.clientKbit * 1000 / 8 / m_config.snapshotHz;
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    protocol::SnapshotHead head;
    head.tick = m_world.Tick();
    head.timeRatio = static_cast<float>(m_clock.TimeRatio());
    head.inputTick = session.inputs.NewestUsed();
    const double credit = session.subscription.sent.LossShare() > kHeavyLoss ? share / 2 : share;
    m_sender.Send(m_captures.Bodies(), encode, session.body, head, credit, now, connection, session.subscription);
  }
  SendForces();
}

bool Server::IsSnapshotDue() const {
  const auto due = [&](std::uint64_t tick) {
    return tick * static_cast<std::uint64_t>(m_config.snapshotHz) / static_cast<std::uint64_t>(m_config.tickHz);
  };
  return CountPlaying() > 0 && due(m_world.Tick()) != due(m_world.Tick() - std::uint64_t{1});
}

void Server::ApplyInputs() {
  const auto holdTicks = static_cast<std::uint32_t>(protocol::kInputHold * m_config.tickHz);
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    const physics::Control control = TakeControl(session, m_world.Tick() + 1, holdTicks);
    if (session.body != 0) m_world.SetControl(session.body, control, m_scene.player.limits);
  }
}

void Server::TakeEvent(const transport::Event& event, double now) {
  using Kind = transport::Event::Kind;
  if (event.kind == Kind::kConnected) {
    Session& session = m_sessions[event.connection];
    session.connection = event.connection;
    session.connectedAt = session.lastHeard = now;
    session.joinPatience = protocol::FindJoinPatience(m_transport->ReadRoundTrip(event.connection));
    if (m_closing) End(session, GoodbyeReason::ServerClosing, "");
    return;
  }
  const auto found = m_sessions.find(event.connection);
  if (found == m_sessions.end()) return;
  Session& session = found->second;
  if (event.kind == Kind::kDisconnected) {
    ForgetPlayer(session, session.state == Session::State::kPlaying);
    m_sessions.erase(found);
    return;
  }
  if (session.state == Session::State::kEnding) return;

  const MessageEffect effect = TakeMessage(session, event.channel, event.bytes, m_world.Tick(), now);
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
      Obey(session, *effect.command);
      break;
  }
}

void Server::Join(Session& session) {
  if (CountPlaying() >= static_cast<std::size_t>(m_config.maxClients)) {
    End(session, GoodbyeReason::ServerFull,
        std::to_string(m_config.maxClients) + " of " + std::to_string(m_config.maxClients) + " players are in");
    return;
  }
  PublishBlueprints();  // to the others: the newcomer gets all of them with its welcome
  session.state = Session::State::kPlaying;
  session.clientId = m_nextClientId++;
  if (!session.spectator) {
    session.body = m_world.AddBody(static_cast<std::uint8_t>(m_scene.player.blueprint),
                                   scenes::FindFreeSpawn(m_scene.player, session.clientId, m_world));
  }
  ++m_counts.joins;
  m_counts.clientsPeak = std::max(m_counts.clientsPeak, CountPlaying());
  spdlog::info("client {} ({}) joined{}", session.clientId, session.name, session.spectator ? " as spectator" : "");
  SendWelcome(session);
  Broadcast(protocol::MakeEvent(EventKind::Join, m_world.Tick(), session.clientId, session.body, session.name));
  if (m_game && session.body != 0) m_game->Enter(session.clientId);
  TellTuning();
}

void Server::SendWelcome(Session& session) {
  protocol::WelcomeFields fields;
  fields.clientId = session.clientId;
  fields.ownBody = session.body;
  fields.tick = m_world.Tick();
  fields.tickHz = static_cast<std::uint16_t>(m_config.tickHz);
  fields.snapshotHz = static_cast<std::uint16_t>(m_config.snapshotHz);
  fields.scene = m_scene.name;
  fields.blueprintCount = static_cast<std::uint16_t>(m_blueprints.size());
  fields.obstacles = CaptureObstacles(m_world.Obstacles());
  for (const CapturedGround& ground : m_grounds) fields.heightFields.push_back(ground.field);
  fields.hands = CaptureHands(m_scene);
  fields.reach = static_cast<float>(m_scene.hands.reach);
  fields.game = m_game ? "sumo" : "";
  fields.workshop = m_workshop ? m_workshop->Body() : 0;
  const auto send = [&](const protocol::Message& message) {
    if (m_transport->Send(session.connection, Channel::kControl, message) != transport::SendResult::kQueued) {
      spdlog::warn("client {}: could not be welcomed", session.clientId);
    }
  };
  send(protocol::MakeWelcome(fields));
  for (std::size_t i = 0; i < m_grounds.size(); ++i) {
    for (const protocol::Message& rows : MakeRows(static_cast<std::uint16_t>(i), m_grounds[i])) send(rows);
  }
  for (std::size_t i = 0; i < m_blueprints.size(); ++i) {
    for (const protocol::Message& chunk : MakeChunks(static_cast<std::uint8_t>(i), m_blueprints[i])) send(chunk);
  }
  // Those who are in already, so that every body has its name.
  for (const auto& [connection, other] : m_sessions) {
    if (other.state != Session::State::kPlaying || &other == &session) continue;
    send(protocol::MakeEvent(EventKind::Join, m_world.Tick(), other.clientId, other.body, other.name));
  }
}

void Server::End(Session& session, GoodbyeReason reason, const std::string& detail) {
  const std::string who = session.clientId != 0 ? fmt::format("client {} ({})", session.clientId, session.name)
                                                : fmt::format("connection {}", session.connection);
  spdlog::info("{} is sent away: {}{}{}", who, protocol::Name(reason), detail.empty() ? "" : ", ", detail);
  if (session.state == Session::State::kAwaitingHello) ++m_counts.refusals;
  ForgetPlayer(session, session.state == Session::State::kPlaying && !m_closing);
  session.state = Session::State::kEnding;
  const protocol::Message goodbye = protocol::MakeServerGoodbye(reason, detail);
  if (m_transport->Send(session.connection, Channel::kControl, goodbye) != transport::SendResult::kQueued) {
    spdlog::debug("client {}: gone before its goodbye", session.clientId);
  }
  m_transport->Disconnect(session.connection);
}

// Takes a player who had joined out of the world; nothing to do for others.
void Server::ForgetPlayer(Session& session, bool unasked) {
  if (session.state != Session::State::kPlaying) return;
  session.state = Session::State::kEnding;
  ++(unasked ? m_counts.disconnects : m_counts.leaves);
  if (unasked) spdlog::info("client {} ({}) was lost", session.clientId, session.name);
  if (session.body != 0) m_world.RemoveBody(session.body);
  Broadcast(protocol::MakeEvent(EventKind::Leave, m_world.Tick(), session.clientId, session.body, session.name));
  if (session.body != 0) Broadcast(protocol::MakeEvent(EventKind::BodyRemoved, m_world.Tick(), 0, session.body, ""));
  session.body = 0;
  m_hands.Forget(session.clientId);
  if (m_game) m_game->Leave(session.clientId);
  if (CountPlaying() == 0) m_tuning.Reset(m_world, m_clock);
  TellTuning();
}

void Server::DropTimedOut(double now) {
  for (auto& [connection, session] : m_sessions) {
    if (const auto reason = FindTimeout(session, now)) End(session, *reason, "");
  }
}

void Server::RespawnFallen() {
  const auto hasFallen = [&](physics::BodyId body) {
    const physics::Vector3d centre = m_world.FindCentre(m_world.ReadBody(body));
    return centre.z() < m_scene.killHeight || centre.cwiseAbs().maxCoeff() > kBorder;
  };
  // By ascending id, both. Whoever rests does not fall.
  auto placed = m_sceneBodies.begin();
  for (const std::uint32_t place : m_world.Stepped()) {
    const physics::BodyId body = m_world.Bodies()[place].id;
    placed = std::lower_bound(placed, m_sceneBodies.end(), body,
                              [](const scenes::PlacedBody& each, physics::BodyId id) { return each.body < id; });
    if (placed == m_sceneBodies.end()) break;
    if (placed->body == body && hasFallen(body)) Respawn(body, placed->home);
  }
  for (const auto& [connection, session] : m_sessions) {
    if (session.body != 0 && !m_world.ReadBody(session.body).asleep && hasFallen(session.body)) {
      NoteFall(session);
      Respawn(session.body, scenes::FindFreeSpawn(m_scene.player, session.clientId, m_world));
    }
  }
}

void Server::Respawn(physics::BodyId body, const physics::Vector3d& place) {
  m_world.PlaceBody(body, place);
  ++m_counts.respawns;
  Broadcast(protocol::MakeEvent(EventKind::Respawn, m_world.Tick(), 0, body, ""));
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

void Server::Close(double now) {
  m_closing = true;
  Receive(now);
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kEnding) End(session, GoodbyeReason::ServerClosing, "");
  }
  m_transport->Flush();
}

std::size_t Server::CountPlaying() const {
  return static_cast<std::size_t>(std::count_if(m_sessions.begin(), m_sessions.end(), [](const auto& entry) {
    return entry.second.state == Session::State::kPlaying;
  }));
}

}  // namespace wobble::server
