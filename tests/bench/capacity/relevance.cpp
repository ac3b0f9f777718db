// What a player sees of a crowd through a budget that holds a few of it. The link is clean, so that only the choice of
// bodies and qualities counts, and the curve between the samples.

#include "tests/bench/capacity/crowd.h"
#include "tests/bench/capacity/experiments.h"
#include "tests/bench/capacity/shown.h"
#include "tests/bench/contact/bodies.h"

namespace wobble::bench {
namespace {

constexpr unsigned kRelevancePlayers = 128;
constexpr unsigned kRelevancePlayersQuick = 48;
constexpr double kRelevanceKbit = 384;  // what a link is given at first
constexpr double kRelevanceDelay = 0.025;
constexpr double kRelevanceWarmUp = 3;  // s
// One of so many rounds of a decoding bot is recorded; neighbouring rounds are alike.
constexpr std::uint64_t kRelevanceKeepEvery = 3;
constexpr std::size_t kNearestPlayers = 24;
// On the scene as it is 24 bodies stand within 6 m of a player. With its walls so many times as far apart, within 16 m.
constexpr double kWide = 8.0 / 3;

// The game on a floor of another breadth.
Game Widen(Game game, double factor) {
  for (physics::Obstacle& each : game.scene.obstacles) each.offset *= factor;
  game.scene.player.spawnRadius *= factor;
  return game;
}

struct Relevance {
  unsigned players = 0;
  double kbit = 0;  // to each, all headers included
  double bytesPerRecord = 0;
  Shown near;
  Shown all;  // within 16 m
};

class Watch {
 public:
  Watch(const Game& game, unsigned players, bots::Script& script);

  void Play(double until, const Bench& bench);
  void BeginToCount() {
    m_isCounting = true;
    m_began = m_now;
    m_before = m_crowd.Server().ReadSendCounts();
  }
  [[nodiscard]] Relevance Finish() const;

 private:
  Crowd m_crowd;
  Truth m_truth{kTickSeconds};
  std::vector<View> m_views;
  std::uint64_t m_rounds = 0;
  bool m_isCounting = false;
  double m_now = 0;
  double m_began = 0;
  server::SendCounts m_before;
};

Watch::Watch(const Game& game, unsigned players, bots::Script& script)
    : m_crowd(game, {.players = players, .clientKbit = kRelevanceKbit, .link = {.delay = kRelevanceDelay}}, script) {
  m_crowd.SetOnShown([this](client::Client& client, std::span<const client::BodySample> shown, double now) {
    if (!m_isCounting || ++m_rounds % kRelevanceKeepEvery != 0) return;
    m_views.push_back(MakeView(client, shown, now));
  });
}

void Watch::Play(double until, const Bench& bench) {
  for (; m_now < until && !bench.progress.IsStopAsked(); m_now += kTickSeconds) {
    m_crowd.Play(m_now, [this](double) { m_truth.Add(m_crowd.Server().World()); });
  }
}

Relevance Watch::Finish() const {
  const server::Server& server = m_crowd.Server();
  std::vector<physics::BodyId> places;
  for (const physics::Body& body : server.World().Bodies()) places.push_back(body.id);
  const server::SendCounts& after = server.ReadSendCounts();
  const auto vertices = static_cast<double>(after.vertices - m_before.vertices);
  const double ofBody = vertices / static_cast<double>(ReadPositions(server.World().Bodies().front()).size());
  return {.players = m_crowd.CountPlaying(),
          .kbit = FindSnapshotKbit(m_before, after) / ((m_now - m_began) * m_crowd.CountPlaying()),
          .bytesPerRecord = static_cast<double>(after.recordBytes - m_before.recordBytes) / ofBody,
          .near = CompareViews(m_views, m_truth, places, kNearestPlayers),
          .all = CompareViews(m_views, m_truth, places)};
}

void AddRow(const char* floor, const Relevance& seen, Results& results) {
  const double leftOut = seen.near.lateShare + seen.near.missingShare;
  results.rows.push_back({{"experiment", "relevance"},
                          {"floor", floor},
                          {"players", seen.players},
                          {"client_kbit", seen.kbit},
                          {"bytes_per_record", seen.bytesPerRecord},
                          {"nearest", kNearestPlayers},
                          {"displayed_error", seen.near.error},
                          {"displayed_error_p50", seen.near.errorP50},
                          {"displayed_error_p99", seen.near.errorP99},
                          {"left_out_share", leftOut},
                          {"all_displayed_error", seen.all.error},
                          {"all_displayed_error_p50", seen.all.errorP50},
                          {"all_late_share", seen.all.lateShare}});
  results.remarks.push_back(
      FormatLine("relevance, %s floor: of %u players at %.0f kbit/s a player sees the nearest %zu at %.2f %% (p50 "
                 "%.2f, p99 %.2f), "
                 "%.2f %% of them late; all within 16 m at %.1f %% (p50 %.2f), %.0f %% late",
                 floor, seen.players, seen.kbit, kNearestPlayers, seen.near.error, seen.near.errorP50,
                 seen.near.errorP99, 100 * leftOut, seen.all.error, seen.all.errorP50, 100 * seen.all.lateShare));
}

}  // namespace

void MeasureRelevance(Bench& bench) {
  const Game game = MakeGame(bench.options);
  const double end = kRelevanceWarmUp + (bench.options.quick ? 2 : 10);
  for (const double factor : {1.0, kWide}) {
    const bool isWide = factor > 1;
    const Game floor = Widen(game, factor);
    std::string fault;
    const auto script = LoadScript(floor, fault);
    if (script == nullptr) return bench.results.remarks.push_back("relevance: " + fault);
    Watch watch(floor, bench.options.quick ? kRelevancePlayersQuick : kRelevancePlayers, *script);
    watch.Play(kRelevanceWarmUp, bench);
    watch.BeginToCount();
    watch.Play(end, bench);
    if (bench.progress.IsStopAsked()) return;
    bench.progress.Show(isWide ? 2 : 1, 2);
    const Relevance seen = watch.Finish();
    AddRow(isWide ? "wide" : "narrow", seen, bench.results);
    const std::string suffix = isWide ? "_wide" : "";
    bench.results.AddFigureAtMost("relevant_error" + suffix, seen.near.error, 0.5, !bench.options.quick);
    bench.results.AddFigureAtMost("relevant_left_out" + suffix, seen.near.lateShare + seen.near.missingShare, 0,
                                  !bench.options.quick);
  }
}

}  // namespace wobble::bench
