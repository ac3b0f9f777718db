// Makes no decisions: it lays out the data of the client library so that the script, which draws, can read it without a
// copy.
#include "client/wasm/session.h"

#include <algorithm>
#include <utility>

namespace wobble::wasm {
namespace {

// Multiplications in one Update: 0.1 ms, and 3 ms while the browser has not optimised the code yet. The page calls
// Update again while a frame has time.
constexpr std::size_t kCompletionWork = 100'000;
constexpr std::size_t kMaxEvents = 1024;  // events and notices kept; the oldest are dropped first

std::shared_ptr<const client::KeptBlueprints> MakeKept(KeptBytes bytes) {
  auto kept = std::make_shared<client::KeptBlueprints>();
  for (std::vector<std::uint8_t>& each : bytes) kept->push_back({protocol::HashBytes(each), std::move(each)});
  return kept;
}

client::Options MakeOptions(std::string name, bool isSpectator) {
  if (name.size() > protocol::kMaxNameBytes) {
    std::size_t end = protocol::kMaxNameBytes;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // at the start of a character
    name.resize(end);
  }
  client::Options options;
  options.name = std::move(name);
  options.spectator = isSpectator;
  return options;
}

}  // namespace

Session::Session(std::string name, bool isSpectator, KeptBytes kept, double now)
    : m_transport(new WebSocketTransport),
      m_client(
          std::unique_ptr<transport::Transport>(m_transport),
          [&] {
            client::Options options = MakeOptions(std::move(name), isSpectator);
            options.kept = MakeKept(std::move(kept));
            options.completionWork = kCompletionWork;
            options.keep = [this](std::uint64_t hash, std::span<const std::uint8_t> bytes) {
              NoteDownload(hash, bytes);
            };
            return options;
          }(),
          now) {
  m_client.OnEvent([this](const client::Client::Event& event) {
    if (m_events.size() == kMaxEvents) m_events.pop_front();
    m_events.push_back(event);
  });
  const auto addNotice = [this](const std::string& text) {
    if (m_notices.size() == kMaxEvents) m_notices.pop_front();
    m_notices.push_back(text);
  };
  m_client.OnNotice(addNotice);
  m_client.OnNextScene([this, addNotice](const std::string& scene) {
    ++m_nextScenes;
    m_events.clear();
    addNotice("next scene: " + scene);
  });
  m_client.OnDecoded([this](const client::DecodedPatch& patch) { m_decoded.Add(patch); });
}

std::uint8_t* Session::PrepareInput(std::size_t size) {
  if (m_input.size() < size) m_input.resize(size);
  return m_input.data();
}

std::span<const std::uint8_t> Session::Input(std::size_t size) const {
  return std::span(m_input).first(std::min(size, m_input.size()));
}

void Session::Sample(double now) {
  m_client.Sample(now, client::Detail::kVertices, m_samples);
  m_bodies.Update(m_samples);
}

const WelcomeView& Session::MakeWelcome() {
  const protocol::WelcomeFields& welcome = m_client.Welcome();
  m_groundViews.clear();
  for (const client::Ground& ground : m_client.Grounds()) {
    GroundView& view = m_groundViews.emplace_back();
    view.corner[0] = ground.corner.x, view.corner[1] = ground.corner.y, view.corner[2] = ground.corner.z;
    view.cellSize = ground.cellSize;
    view.columns = static_cast<std::uint32_t>(ground.columns);
    view.rows = static_cast<std::uint32_t>(ground.rows);
    view.heights = AddressOf(ground.heights.data());
  }
  m_welcomeView.clientId = welcome.clientId;
  m_welcomeView.ownBody = welcome.ownBody;
  m_welcomeView.tickHz = welcome.tickHz;
  m_welcomeView.snapshotHz = welcome.snapshotHz;
  m_welcomeView.scene = MakeText(welcome.scene);
  m_welcomeView.obstacleCount = static_cast<std::uint32_t>(welcome.obstacles.size());
  m_welcomeView.obstacles = AddressOf(welcome.obstacles.data());
  m_welcomeView.groundCount = static_cast<std::uint32_t>(m_groundViews.size());
  m_welcomeView.grounds = AddressOf(m_groundViews.data());
  m_welcomeView.hands = welcome.hands;
  m_welcomeView.reach = welcome.reach;
  m_welcomeView.game = MakeText(welcome.game);
  m_welcomeView.workshop = welcome.workshop;
  m_welcomeView.rank = static_cast<std::uint32_t>(welcome.rank);
  m_welcomeView.description = MakeText(welcome.description);
  m_welcomeView.talk = welcome.talk;
  return m_welcomeView;
}

const StatisticsView& Session::MakeStatistics(double now) {
  const client::Statistics& from = m_client.ReadStatistics();
  StatisticsView& to = m_statisticsView;
  to.snapshots = static_cast<float>(from.snapshots);
  to.records = static_cast<float>(from.records);
  to.badMessages = static_cast<float>(from.badMessages + from.badSnapshots + from.badRecords);
  to.bytesReceived = static_cast<float>(from.bytesReceived);
  to.stalls = static_cast<float>(from.stalls);
  to.delay = static_cast<float>(m_client.InterpolationDelay());
  to.inputToSnapshot = static_cast<float>(from.inputToSnapshot);
  to.snapshotAge = static_cast<float>(from.snapshotAge);
  to.timeRatio = static_cast<float>(from.timeRatio);
  to.lossShare = static_cast<float>(from.lossShare);
  to.serverTime = static_cast<float>(m_client.ServerTime(now));
  to.joinSeconds = static_cast<float>(from.joinSeconds);
  to.pace = static_cast<float>(m_client.Pace());
  return to;
}

const EventView* Session::TakeEvent() {
  if (m_events.empty()) return nullptr;
  m_event = std::move(m_events.front());
  m_events.pop_front();
  m_eventView.kind = static_cast<std::uint32_t>(m_event.kind);
  m_eventView.clientId = m_event.clientId;
  m_eventView.body = m_event.body;
  m_eventView.name = MakeText(m_event.name);
  m_eventView.emote = static_cast<std::uint32_t>(m_event.emote);
  return &m_eventView;
}

const Text* Session::TakeNotice() {
  if (m_notices.empty()) return nullptr;
  m_notice = std::move(m_notices.front());
  m_notices.pop_front();
  m_noticeView = MakeText(m_notice);
  return &m_noticeView;
}

void Session::NoteDownload(std::uint64_t hash, std::span<const std::uint8_t> bytes) {
  if (m_downloadedBytes + bytes.size() > protocol::kMaxKeptBytes) return;
  m_downloadedBytes += bytes.size();
  m_downloads.push_back({hash, {bytes.begin(), bytes.end()}});
}

const DownloadView* Session::TakeDownload() {
  if (m_downloads.empty()) return nullptr;
  m_download = std::move(m_downloads.front());
  m_downloads.pop_front();
  m_downloadedBytes -= m_download.bytes.size();
  m_downloadView = {.hashLow = static_cast<std::uint32_t>(m_download.hash),
                    .hashHigh = static_cast<std::uint32_t>(m_download.hash >> 32),
                    .bytes = AddressOf(m_download.bytes.data()),
                    .length = static_cast<std::uint32_t>(m_download.bytes.size())};
  return &m_downloadView;
}

const TuningView& Session::MakeTuning() {
  const client::Tuning& tuning = m_client.ReadTuning();
  m_tuningView = {.gravity = {tuning.gravity.x, tuning.gravity.y, tuning.gravity.z},
                  .stiffness = tuning.stiffness,
                  .timeRate = tuning.timeRate,
                  .may = tuning.may};
  return m_tuningView;
}

const ScoreboardView& Session::MakeScoreboard() {
  const client::Scoreboard& board = m_client.ReadScoreboard();
  m_scoreboardView = {.phase = static_cast<std::uint32_t>(board.phase),
                      .round = board.round,
                      .secondsLeft = board.secondsLeft,
                      .pointsToWin = board.pointsToWin,
                      .winner = board.winner,
                      .scoreCount = static_cast<std::uint32_t>(board.scores.size()),
                      .scores = AddressOf(board.scores.data()),
                      .seats = AddressOf(board.seats.data()),
                      .rounds = board.rounds,
                      .winningSide = board.winningSide,
                      .object = board.object,
                      .bearer = board.bearer,
                      .sideCount = static_cast<std::uint32_t>(board.sides.size()),
                      .sides = AddressOf(board.sides.data())};
  return m_scoreboardView;
}

const ForcesView& Session::MakeForces() {
  const client::Forces& forces = m_client.ReadForces();
  m_fieldViews.clear();
  for (const protocol::ForceField& field : forces.fields) {
    m_fieldViews.push_back({.kind = static_cast<std::uint32_t>(field.kind),
                            .count = static_cast<std::uint32_t>(field.values.size()),
                            .values = AddressOf(field.values.data())});
  }
  m_forcesView = {.body = forces.body,
                  .tick = forces.tick,
                  .stride = forces.stride,
                  .fieldCount = static_cast<std::uint32_t>(m_fieldViews.size()),
                  .fields = AddressOf(m_fieldViews.data())};
  return m_forcesView;
}

void Session::Build(const BuildRequest& request) {
  protocol::BuildFields fields;
  fields.kind = static_cast<protocol::wire::BuildKind>(request.kind);
  fields.a = static_cast<std::uint16_t>(request.a);
  fields.b = static_cast<std::uint16_t>(request.b);
  fields.at = {request.at[0], request.at[1], request.at[2]};
  fields.mass = request.mass;
  fields.fixed = request.fixed != 0;
  fields.stiffness = request.stiffness;
  fields.damping = request.damping;
  fields.restLength = request.restLength;
  m_client.Build(fields);
}

}  // namespace wobble::wasm
