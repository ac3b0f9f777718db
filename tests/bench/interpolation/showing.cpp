// The server runs at 240 Hz, because the truth is needed at any moment and a ball's vibration between ticks of 1/60 s
// is no cubic. Its snapshot rate is a parameter. Players have links without delay, so that their actions, and hence the
// play, are the same to the bit whatever links the watchers have. Watchers draw frames at a rate unrelated to the
// server's and receive packets when they draw, as the programs do.
#include "tests/bench/interpolation/showing.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>

#include "client/client.h"
#include "protocol/snapshot.h"
#include "protocol/transport/virtual_network.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "tests/bench/codec/play.h"
#include "tests/bench/codec/recording.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/interpolation/transport_group.h"
#include "tests/bench/interpolation/truth.h"
#include "tests/bench/packet_header.h"

namespace wobble::bench {
namespace {

constexpr int kTickHz = 240;
constexpr int kTicksPerAct = kTickHz / 60;
constexpr double kFrameSeconds = 1 / 61.8;
constexpr double kWarmUp = 5;  // s
constexpr double kRadius = 1;  // m
constexpr double kPercent = 100 / kRadius;

constexpr const char* kScene = R"(
[[obstacle]]
kind = "plane"
[[blueprint]]
name = "ball"
radius = 1
mass = 40.5
stiffness = 750
gas = 4500
damping_ratio = 0.3
[player]
blueprint = "ball"
spawn = [0, 0, 1.5]
spawn_radius = 2
acceleration = 12
speed = 4
jump_speed = 3
)";

scenes::Scene MakeScene() {
  scenes::Scene scene = scenes::ParseScene(kScene, "showing").scene;
  scene.obstacles = MakeArena();
  return scene;
}

class Seat {
 public:
  Seat(const Watcher& watcher, std::uint64_t seed, double now)
      : m_network({.seed = seed}),
        m_server(m_network.MakeServer()),
        m_client(m_network.MakeClient(), {.spectator = true, .curve = watcher.curve}, now) {
    m_network.SetConditions(watcher.link.conditions);
  }

  // Call once, for the TransportGroup.
  [[nodiscard]] std::unique_ptr<transport::Transport> TakeServer() { return std::move(m_server); }

  void Draw(double now, bool counts, double serverTime, const physics::World& world, const Truth& truth);
  void BeginToCount(const TransportGroup::Sent& sent) {
    m_begin = m_client.ReadStatistics();
    m_sentBefore = sent;
  }
  [[nodiscard]] Seen Finish(const TransportGroup::Sent& sent, double seconds);

 private:
  transport::VirtualNetwork m_network;
  std::unique_ptr<transport::Transport> m_server;
  client::Client m_client;
  std::vector<double> m_squares;  // mean over vertices per body and frame, m²
  std::vector<client::BodySample> m_samples;
  std::vector<Vector3d> m_true;  // scratch
  client::Statistics m_begin;
  TransportGroup::Sent m_sentBefore;
  double m_delays = 0;
  std::size_t m_frames = 0;
};

void Seat::Draw(double now, bool counts, double serverTime, const physics::World& world, const Truth& truth) {
  m_client.Update(now);
  m_client.Sample(now, client::Detail::kVertices, m_samples);
  if (!counts || m_client.ReadState() != client::State::kPlaying) return;
  const double moment = m_client.ServerTime(now) - m_client.InterpolationDelay();
  m_delays += serverTime - moment;
  ++m_frames;
  const auto bodies = world.Bodies();
  for (std::size_t place = 0; place < bodies.size(); ++place) {
    const auto sample = std::find_if(m_samples.begin(), m_samples.end(),
                                     [&](const client::BodySample& each) { return each.body == bodies[place].id; });
    if (sample == m_samples.end() || !truth.Find(moment, place, m_true)) {
      throw std::runtime_error("a watcher misses a body, or the truth of its moment is not recorded");
    }
    m_squares.push_back(FindMeanSquare(*sample, m_true));
  }
}

Seen Seat::Finish(const TransportGroup::Sent& sent, double seconds) {
  Seen seen;
  seen.disconnected = m_client.ReadState() != client::State::kPlaying;
  if (m_squares.empty()) return seen;
  double sum = 0;
  for (const double square : m_squares) sum += square;
  seen.error = kPercent * std::sqrt(sum / static_cast<double>(m_squares.size()));
  const auto p99 = m_squares.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(m_squares.size()));
  std::nth_element(m_squares.begin(), p99, m_squares.end());
  seen.errorP99 = kPercent * std::sqrt(*p99);
  seen.delay = m_delays / static_cast<double>(m_frames);
  const client::Statistics& statistics = m_client.ReadStatistics();
  seen.heldShare = static_cast<double>(statistics.framesHeld - m_begin.framesHeld) /
                   static_cast<double>(statistics.framesSampled - m_begin.framesSampled);
  const auto packets = static_cast<double>(sent.packets - m_sentBefore.packets);
  const auto bytes = static_cast<double>(sent.bytes - m_sentBefore.bytes);
  const double kbit = 8e-3 / (seconds * kFixedPlayers);
  seen.recordKbit = kbit * (bytes - packets * static_cast<double>(protocol::kSnapshotHeadBytes));
  seen.sentKbit = kbit * (bytes + packets * kPacketHeaderBytes);
  return seen;
}

class Game {
 public:
  Game(int snapshotHz, const std::vector<Watcher>& watchers, std::uint64_t seed);

  void Play(double until);
  void BeginToCount();
  [[nodiscard]] Showing Finish(double seconds);

 private:
  void Tick(double now);
  void ActForPlayers();

  transport::VirtualNetwork m_playersNetwork;
  std::deque<client::Client> m_players;
  std::vector<Actor> m_actors;
  std::deque<Seat> m_seats;
  std::shared_ptr<TransportGroup::SentOfEach> m_sent = std::make_shared<TransportGroup::SentOfEach>();
  std::optional<server::Server> m_server;
  Truth m_truth{1.0 / kTickHz};
  std::vector<double> m_speeds;
  bool m_isCounting = false;
  double m_nextFrame = 0;
  double m_lastTick = 0;
};

Game::Game(int snapshotHz, const std::vector<Watcher>& watchers, std::uint64_t seed) {
  std::vector<std::unique_ptr<transport::Transport>> members;
  members.push_back(m_playersNetwork.MakeServer());
  for (const Watcher& watcher : watchers) {
    m_seats.emplace_back(watcher, seed, 0);
    members.push_back(m_seats.back().TakeServer());
  }
  server::Config config;
  config.tickHz = kTickHz;
  config.snapshotHz = snapshotHz;
  const std::vector<server::Bases> bases{TrainBasesAsServer(MakePlayedBall())};
  config.clientKbit = server::kClientKbitRange.high;
  m_server.emplace(config, MakeScene(), std::make_unique<TransportGroup>(std::move(members), m_sent), 0, bases);
  for (std::size_t i = 0; i < kFixedPlayers; ++i) {
    m_players.emplace_back(m_playersNetwork.MakeClient(), client::Options{.decode = false}, 0);
    m_actors.emplace_back(seed, i);
  }
}

void Game::Play(double until) {
  for (;;) {
    const double tick = m_server->NextCall();
    const double next = std::min(tick, m_nextFrame);
    if (next >= until) return;
    if (tick <= m_nextFrame) {
      Tick(next);
    } else {
      const double serverTime = m_server->World().Tick() / static_cast<double>(kTickHz) + next - m_lastTick;
      for (Seat& seat : m_seats) seat.Draw(next, m_isCounting, serverTime, m_server->World(), m_truth);
      m_nextFrame += kFrameSeconds;
    }
  }
}

void Game::Tick(double now) {
  if (m_server->World().Tick() % kTicksPerAct == 0) ActForPlayers();
  for (client::Client& player : m_players) player.Update(now);
  m_server->Tick(now);
  m_lastTick = now;
  const physics::World& world = m_server->World();
  m_truth.Add(world);
  if (!m_isCounting) return;
  for (const physics::Body& body : world.Bodies()) m_speeds.push_back(FindVelocity(world, body).norm());
}

void Game::ActForPlayers() {
  const physics::World& world = m_server->World();
  if (world.Bodies().size() != kFixedPlayers) return;
  for (std::size_t i = 0; i < kFixedPlayers; ++i) {
    const physics::Control control = m_actors[i].Act(Pattern::kChase, world);
    m_players[i].SetInput({static_cast<float>(control.moveX), static_cast<float>(control.moveY), control.jump});
  }
}

void Game::BeginToCount() {
  m_isCounting = true;
  for (std::size_t i = 0; i < m_seats.size(); ++i) m_seats[i].BeginToCount((*m_sent)[i + 1]);
}

Showing Game::Finish(double seconds) {
  Showing showing;
  for (std::size_t i = 0; i < m_seats.size(); ++i) {
    showing.watchers.push_back(m_seats[i].Finish((*m_sent)[i + 1], seconds));
  }
  showing.codecError = m_server->ReadSendCounts().ErrorPercentRms();
  showing.truthErrorOfHalf = kPercent * m_truth.ErrorOfHalf();
  showing.speedMedian = FindMedian(m_speeds);
  return showing;
}

}  // namespace

const std::vector<NamedLink>& ListLinks() {
  static const std::vector<NamedLink> links{
      {"clean", {.delay = 0.025}},
      {"5 % loss, 20 ms jitter", {.loss = 0.05, .delay = 0.025, .jitter = 0.02}},
      {"20 % loss, 100 +- 50 ms, 4 % reordered", {.loss = 0.2, .delay = 0.05, .jitter = 0.1, .reorder = 0.04}},
  };
  return links;
}

double FindMeanSquare(const client::BodySample& shown, const std::vector<Vector3d>& vertices) {
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const protocol::Vector3& seen = shown.vertices[i];
    sum += (Vector3d(seen.x, seen.y, seen.z) - vertices[i]).squaredNorm();
  }
  return sum / static_cast<double>(vertices.size());
}

Showing PlayShowing(int snapshotHz, const std::vector<Watcher>& watchers, std::uint64_t seed, double seconds) {
  spdlog::set_level(spdlog::level::off);
  Game game(snapshotHz, watchers, seed);
  game.Play(kWarmUp);
  game.BeginToCount();
  game.Play(kWarmUp + seconds);
  return game.Finish(seconds);
}

}  // namespace wobble::bench
