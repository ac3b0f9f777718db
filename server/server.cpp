// One tick, top to bottom: Receive, Step, Capture, Send, which has a body encoded once for all clients when the first
// of them takes it. Calls only go down; nothing but inputs and acknowledgements comes back up.
//
// Captured and encoded ahead of the choice, a thousand moving bodies were shown to nobody for the most part: the share
// of sixteen clients is a few dozen of them. So only what is likely to be taken is, and where there are threads to
// share the work.
#include "server/server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cassert>

namespace wobble::server {

using protocol::wire::EventKind;

namespace {

// Beyond this the wire cannot show a body any more; it starts again like one that fell, metres.
constexpr double kBorder = 0.9 * protocol::kWorldHalfExtent;

// While the world waits for somebody, s: what their first packet may have to wait as well.
constexpr double kPausedPoll = 0.02;

// Fewer are encoded in no time, and a packet after each tick would cost more than it spreads.
constexpr std::size_t kManyBodies = 32;

// A client that loses more than this gets half its bytes: its link is full, and ENet's own throttle is off.
constexpr double kHeavyLoss = 0.1;

}  // namespace

Server::Server(const Config& config, scenes::Scene scene, std::unique_ptr<transport::Transport> transport, double now,
               std::vector<Bases> bases, server::Clock clock)
    : m_config(config),
      m_scene(std::move(scene)),
      m_transport(std::move(transport)),
      m_world(scenes::MakeWorldSettings(m_scene, 1.0 / config.tickHz, config.threads)),
      m_sceneBodies(scenes::FillWorld(m_scene, config.seed, m_world)),
      m_grounds(CaptureGrounds(m_world.Obstacles())),
      m_bases(std::move(bases)),
      m_encoder(CaptureObstacles(m_world.Obstacles()), config.threads),
      m_sender(*m_transport, config.viewDistance),
      m_clock(1.0 / config.tickHz, now),
      m_watch(std::move(clock)),
      m_load(1.0 / config.tickHz),
      m_snapshotHz(config.snapshotHz),
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
  m_watch.Begin(Phase::kReceive);
  Receive(now);
  PauseOrGoOn(now);
  const int jumped = m_isPaused ? 0 : m_clock.TakeJumpTicks();
  const int due = m_isPaused ? 0 : m_clock.TakeDueTicks(now);
  m_lastTicks.clear();
  for (int i = 0; i < jumped + due; ++i) {
    Step();
    if (const auto share = i < jumped ? std::nullopt : FindShare()) {
      Capture();
      Send(*share, now);
    }
    m_lastTicks.push_back(m_watch.Take());
  }
  m_watch.Enter(Phase::kSend);
  m_transport->Flush();
  m_watch.End();
  if (due > 0) FollowLoad(static_cast<std::size_t>(due), now);
  return jumped + due;
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
    m_load = server::Load(1.0 / m_config.tickHz);
  }
  m_lastCall = now;
  const bool isAlone = m_config.pauseAfter > 0 && now - m_lastCompany > m_config.pauseAfter;
  if (isAlone == m_isPaused) return;
  m_isPaused = isAlone;
  spdlog::info("tick {}: {}", m_world.Tick(), isAlone ? "nobody is here, the world waits" : "the world goes on");
}

double Server::NextCall() const { return m_isPaused ? m_lastCall + kPausedPoll : m_clock.NextTick(); }

void Server::Step() {
  m_watch.Enter(Phase::kStep);
  ApplyInputs();
  ActByHand();
  m_report = m_world.Step();
  const physics::StepReport& report = m_report;
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
  m_watch.Enter(Phase::kCapture);
  PublishBlueprints();
  m_encoder.Follow(m_captures.Bodies(), m_world.Tick());
}

void Server::PublishBlueprints() {
  if (m_publishedRevision == m_world.Changes().blueprintRevision) return;
  m_publishedRevision = m_world.Changes().blueprintRevision;
  const std::span<const physics::Blueprint> present = m_world.Blueprints();
  for (std::size_t slot = 0; slot < present.size(); ++slot) {
    const auto number = static_cast<std::uint8_t>(slot);
    const bool isNew = slot == m_blueprints.size();
    if (!isNew && m_blueprints[slot].revision == m_world.Changes().slots[slot].revision) continue;
    const bool isWorkshop = m_workshop && m_world.ReadBody(m_workshop->Body()).blueprint == number;
    const BlueprintTags tags =
        isWorkshop ? CaptureTags(present[slot], m_workshop->Particles(), m_workshop->Springs()) : BlueprintTags{};
    CapturedBlueprint fresh = CaptureBlueprint(present[slot], FindBases(slot), tags);
    fresh.revision = m_world.Changes().slots[slot].revision;
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

void Server::EncodeAhead(Share share) {
  if (m_config.threads == 1) return;
  m_watch.Enter(Phase::kCapture);
  m_fresh.clear();
  const std::span<const ShownBody> bodies = m_captures.Bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!share.Has(bodies[i].body) || m_captures.Version(i) != 0 || !m_encoder.IsExpected(i)) continue;
    const CapturedBody& captured = m_captures.Read(m_world, i);
    m_fresh.push_back({i, &captured, &m_blueprints[captured.blueprint]});
  }
  m_watch.Enter(Phase::kEncode);
  m_encoder.EncodeAhead(m_fresh);
}

const EncodedBody& Server::Encode(std::size_t index, std::size_t quality) {
  if (const EncodedBody* known = m_encoder.Find(index, quality, m_captures.Version(index))) return *known;
  m_watch.Enter(Phase::kCapture);
  const CapturedBody& captured = m_captures.Read(m_world, index);
  m_watch.Enter(Phase::kEncode);
  const EncodedBody& encoded = m_encoder.Encode(index, quality, captured, m_blueprints[captured.blueprint]);
  m_watch.Enter(Phase::kSend);
  return encoded;
}

void Server::Send(Share share, double now) {
  EncodeAhead(share);
  m_watch.Enter(Phase::kSend);
  const auto encode = [this](std::size_t index, std::size_t quality) -> const EncodedBody& {
    return Encode(index, quality);
  };
  const double bytes = m_config.clientKbit * 1000 / 8 / m_config.snapshotHz / share.groups;
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    protocol::SnapshotHead head;
    head.tick = m_world.Tick();
    head.timeRatio = static_cast<float>(m_clock.TimeRatio());
    head.inputTick = session.inputs.NewestUsed();
    const double credit = session.subscription.sent.LossShare() > kHeavyLoss ? bytes / 2 : bytes;
    m_sender.Send(m_captures.Bodies(), encode, session.body, head, share, credit, now, connection,
                  session.subscription);
  }
  if (share.group == 0) SendForces();
  m_transport->Flush();
}

// Where there are many bodies, each is sent as often, but not all after the same tick: to encode them all at once would
// make every second tick twice as long as the others, and the longest tick is what a machine must have time for.
std::optional<Share> Server::FindShare() const {
  if (CountPlaying() == 0) return {};
  const auto tick = m_world.Tick();
  const auto tickHz = static_cast<std::uint32_t>(m_config.tickHz), hz = static_cast<std::uint32_t>(m_snapshotHz);
  if (m_captures.Bodies().size() >= kManyBodies && tickHz % hz == 0) return Share{tick % (tickHz / hz), tickHz / hz};
  const auto due = [&](std::uint64_t each) { return each * hz / tickHz; };
  return due(tick) != due(tick - std::uint64_t{1}) ? std::optional(Share{}) : std::nullopt;
}

// After so many ticks that were due together.
void Server::FollowLoad(std::size_t due, double now) {
  double spent = 0;
  for (const PhaseTimes& tick : LastTicks().last(due)) spent += tick.Sum();
  const LoadLevel before = m_load.Level();
  m_load.Record(spent / static_cast<double>(due), m_clock.Rate(), now);
  m_clock.SetLimit(m_load.RateLimit());
  const LoadLevel level = m_load.Level();
  m_sender.SetCoarser(level >= LoadLevel::kCoarser);
  m_snapshotHz = level >= LoadLevel::kBusy ? std::min(m_config.snapshotHz, kBusySnapshotHz) : m_config.snapshotHz;
  if (level == before) return;
  spdlog::log(level > before ? spdlog::level::warn : spdlog::level::info,
              "tick {}: ticks take {:.0f} % of the time there is for them, load level {}", m_world.Tick(),
              100 * m_load.Share(), Name(level));
}

void Server::ApplyInputs() {
  const auto holdTicks = static_cast<std::uint32_t>(protocol::kInputHold * m_config.tickHz);
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    const physics::Control control = TakeControl(session, m_world.Tick() + 1, holdTicks);
    if (session.body != 0) m_world.SetControl(session.body, control, m_scene.player.limits);
  }
}

void Server::RespawnFallen() {
  const auto hasFallen = [&](physics::BodyId body) {
    const physics::Vector3d centre = m_world.FindCentre(m_world.ReadBody(body));
    return centre.z() < m_scene.killHeight || centre.cwiseAbs().maxCoeff() > kBorder;
  };
  // By ascending id, both. Whoever rests does not fall.
  auto placed = m_sceneBodies.begin();
  for (const std::uint32_t place : m_world.Changes().stepped) {
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

}  // namespace wobble::server
