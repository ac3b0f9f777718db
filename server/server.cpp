// The tick of the server. Server::Tick reads from top to bottom: Receive, Step, Capture, Encode, Send. Calls only go
// down; only inputs and acknowledgements come back up.
//
// Capture and Encode prepare what is likely to be sent; Send captures and encodes the rest when it takes a body (see
// snapshots/snapshot_store.cpp for why not all of it is done ahead).
#include "server/server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cassert>

namespace wobble::server {

using protocol::wire::EventKind;

namespace {

static_assert(kBorder <= 0.9 * protocol::kWorldHalfExtent);

// Time between two calls while the world is paused, s: also the longest that a first packet waits.
constexpr double kPausedPoll = 0.05;

// From this many bodies on a snapshot is spread over several ticks. Fewer are encoded quickly, and the packets after
// every tick would cost more than the spreading saves.
constexpr std::size_t kManyBodies = 32;

}  // namespace

Server::Server(const Config& config, scenes::Scene scene, std::unique_ptr<transport::Transport> transport, double now,
               std::vector<Bases> bases, TimeSource clock)
    : m_config(config),
      m_transport(std::move(transport)),
      m_clock(1.0 / config.tickHz, now),
      m_watch(std::move(clock)),
      m_stage(std::make_unique<Stage>(m_config, std::move(scene), std::move(bases), m_watch)),
      m_budget(*m_transport, config.viewDistance),
      m_load(1.0 / config.tickHz),
      m_snapshotHz(config.snapshotHz),
      m_lastCompany(now),
      m_lastCall(now) {
  assert(m_config.afterMatch == AfterMatch::kNext || Validate(m_config, m_stage->playground.Scene()).empty());
  PublishBlueprints();
}

int Server::Tick(double now) {
  m_watch.Begin(Phase::kReceive);
  Receive(now);
  FollowVote(now);
  LiftMutes(now);
  FollowRotation(now);
  SendDownloads();
  PauseOrResume(now);
  // What a film on its way takes of the time is no load: it leaves room for who watches.
  const bool isSeeking = m_film != nullptr && m_film->IsSeeking();
  const int jumped = m_isPaused ? 0 : m_clock.TakeJumpTicks();
  const int due = m_isPaused ? 0 : m_clock.TakeDueTicks(now);
  m_lastTicks.clear();
  for (int i = 0; i < jumped + due; ++i) {
    Step();
    const bool isJump = i < jumped;
    if (const auto bodies = isJump ? std::nullopt : FindDueBodies()) {
      Capture();
      Encode(*bodies);
      Send(*bodies, now);
    }
    m_lastTicks.push_back(m_watch.Take());
  }
  m_watch.Enter(Phase::kSend);
  m_transport->Flush();
  m_watch.End();
  if (due > 0 && !isSeeking) FollowLoad(static_cast<std::size_t>(due), now);
  return jumped + due;
}

void Server::Record(recording::RecorderSettings settings, recording::Head head) {
  m_recorder = std::make_unique<recording::Recorder>(std::move(settings), std::move(head), m_stage->playground);
  RecordStage();
}

void Server::RecordStage() {
  m_stage->playground.SetListener([this](const Entry& entry) { m_recorder->Note(entry, World().Tick()); });
}

void Server::EndRecording() {
  if (m_recorder != nullptr) m_recorder->Close();
}

void Server::Receive(double now) {
  m_transport->Poll(now, [&](const transport::Event& event) { TakeEvent(event, now); });
  EndTimedOut(now);
  ClearSeats(now);
}

void Server::Step() {
  m_watch.Enter(Phase::kStep);
  FollowMatch();
  ApplyInputs();
  ++m_shownTick;
  if (m_film != nullptr) return ShowFilm();
  SetRounds();
  m_report = m_stage->playground.Step();
  if (m_recorder != nullptr) m_recorder->FollowTick(m_stage->playground);
  if (World().Tick() % static_cast<std::uint32_t>(m_config.tickHz) == 0) SaveState();
  const physics::StepReport& report = m_report;
  m_counts.substeps += report.substeps;
  m_counts.awakeSum += report.awake;
  m_counts.nonFinite += report.nonFinite;
  m_counts.inverted += report.inverted;
  m_counts.quarantined += report.quarantined;
  m_counts.reset += report.reset;
  m_counts.torn += report.torn;
  if (report.quarantined > 0) {
    spdlog::warn("tick {}: {} bodies stepped again in more substeps ({} not finite), {} of them reset", World().Tick(),
                 report.quarantined, report.nonFinite, report.reset);
  }
  TellHappenings();
  TellStandings();
  m_stage->store.FollowStep(m_shownTick);
}

void Server::Capture() {
  m_watch.Enter(Phase::kCapture);
  PublishBlueprints();
  m_stage->store.BeginSnapshot();
}

void Server::Encode(BodySubset due) { m_stage->store.EncodeAhead(due); }

void Server::Send(BodySubset due, double now) {
  m_watch.Enter(Phase::kSend);
  const double ceiling = 1000 * m_config.clientKbit;
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    SnapshotTask task;
    task.connection = connection;
    task.ownBody = session.body;
    task.head.tick = m_shownTick;
    task.head.timeRatio = static_cast<float>(m_clock.TimeRatio());
    task.head.inputTick = session.inputs.NewestUsed();
    task.subset = due;
    Subscription& subscription = session.subscription;
    subscription.room.Follow(subscription.sent, subscription.isShort, ceiling, now);
    task.creditBytes = subscription.room.Rate(ceiling) / 8 / m_config.snapshotHz / due.divisor;
    task.now = now;
    task.download = &session.download;
    m_budget.Spend(m_stage->store, task, subscription);
  }
  if (due.remainder == 0) SendForces();
  m_transport->Flush();
}

void Server::PauseOrResume(double now) {
  if (!m_sessions.empty()) m_lastCompany = now;
  if (m_isPaused) {
    m_counts.pausedTime += now - m_lastCall;
    m_clock.StandStill(now);
    m_load = LoadController(1.0 / m_config.tickHz);
  }
  m_lastCall = now;
  const bool isAlone = m_config.pauseAfter > 0 && now - m_lastCompany > m_config.pauseAfter;
  if (isAlone == m_isPaused) return;
  m_isPaused = isAlone;
  if (isAlone) SaveState();
  spdlog::info("tick {}: {}", World().Tick(), isAlone ? "nobody is connected, the world pauses" : "the world resumes");
}

double Server::NextCall() const { return m_isPaused ? m_lastCall + kPausedPoll : m_clock.NextTick(); }

void Server::PublishBlueprints() {
  for (const std::uint8_t slot : m_stage->store.FollowBlueprints(m_stage->playground.ReadWorkshop())) {
    for (auto& [connection, session] : m_sessions) {
      if (session.state == Session::State::kPlaying) session.download.Renew(slot);
    }
  }
  SendDownloads();
}

// A world of many bodies sends a part of them after every tick, so that each body still comes snapshotHz times a
// second. Encoding all of them after every second tick would make that tick twice as long, and the machine must have
// time for the longest tick.
std::optional<BodySubset> Server::FindDueBodies() const {
  if (CountPlaying() == 0 || (m_film != nullptr && m_film->IsGathering())) return {};
  const auto tick = m_shownTick;
  const auto tickHz = static_cast<std::uint32_t>(m_config.tickHz), hz = static_cast<std::uint32_t>(m_snapshotHz);
  if (m_stage->store.Bodies().size() >= kManyBodies && tickHz % hz == 0) {
    const std::uint32_t parts = tickHz / hz;
    return BodySubset{.remainder = tick % parts, .divisor = parts};
  }
  const auto countDue = [&](std::uint64_t ticks) { return ticks * hz / tickHz; };
  return countDue(tick) != countDue(tick - std::uint64_t{1}) ? std::optional(BodySubset{}) : std::nullopt;
}

void Server::FollowLoad(std::size_t ticks, double now) {
  double spent = 0;
  for (const PhaseTimes& tick : LastTicks().last(ticks)) spent += tick.Sum();
  const LoadLevel before = m_load.Level();
  m_load.Record(spent / static_cast<double>(ticks), m_clock.Rate(), now);
  m_clock.SetLimit(m_load.RateLimit());
  const LoadLevel level = m_load.Level();
  m_budget.SetCoarser(level >= LoadLevel::kCoarser);
  m_snapshotHz = level >= LoadLevel::kBusy ? std::min(m_config.snapshotHz, kBusySnapshotHz) : m_config.snapshotHz;
  if (level == before) return;
  spdlog::log(level > before ? spdlog::level::warn : spdlog::level::info,
              "tick {}: ticks take {:.0f} % of the time there is for them, load level {}", World().Tick(),
              100 * m_load.Share(), Name(level));
}

void Server::ApplyInputs() {
  const auto holdTicks = static_cast<std::uint32_t>(protocol::kInputHold * m_config.tickHz);
  for (auto& [connection, session] : m_sessions) {
    if (session.state != Session::State::kPlaying) continue;
    const std::uint64_t starved = session.inputs.CountStarved();
    const physics::Control control = TakeControl(session, m_shownTick + 1, holdTicks);
    if (session.body == 0) continue;
    ++m_counts.inputsDue;
    m_counts.inputsStarved += session.inputs.CountStarved() - starved;
    MoveEntry move{session.clientId, control, session.hand};
    if (session.isMuted) move.hand.reset();
    if (!m_stage->playground.IsInForce(move)) m_stage->playground.Take(move);
  }
}

}  // namespace wobble::server
