// Increasing player counts, each with a new server, until one does not hold. A quick run stops at the required count.
// In a full run the largest count that held plays on for five minutes; if it does not hold them, or more ticks than one
// in a thousand exceed the budget, the next smaller count plays them.
#include "tests/bench/capacity/cores.h"
#include "tests/bench/capacity/experiments.h"
#include "tests/bench/capacity/measured.h"
#include "tests/bench/thread_time.h"
#include "tests/bench/throughput/peak.h"

namespace wobble::bench {
namespace {

constexpr unsigned kCounts[] = {1, 2, 4, 8, 16, 32, 48, 64, 80, 96, 112, 128, 192, 256, 384, 512};
constexpr unsigned kQuickCounts[] = {1, 8, 32, 64};
// With AVX2 the limit is 5/3 of the 48 that were held before crowds were made cheaper.
constexpr unsigned kAskedWithAvx512 = 128;
constexpr unsigned kAskedWithAvx2 = 80;
constexpr double kMostOverruns = 0.001;  // share of ticks
constexpr unsigned kQuickPlayers = 8;    // holds despite other load of the machine
constexpr double kAskedKbit = 1500;
constexpr Timetable kQuickTimes{.settle = 2, .count = 3, .show = 1};
constexpr Timetable kTimes{};
constexpr Timetable kLongTimes{.count = 300};

double FindSeconds(std::span<const unsigned> counts, const Timetable& times) {
  return static_cast<double>(counts.size()) * (times.settle + times.count + times.show);
}

class Ladder {
 public:
  // planned: total duration if every count holds, s.
  Ladder(Bench& bench, double planned) : m_bench(bench), m_game(MakeGame(bench.options)), m_planned(planned) {}

  // Plays the counts until one does not hold; returns all that were played.
  std::vector<Measured> Climb(std::span<const unsigned> counts, const Timetable& times);
  // Plays five minutes of the largest count that held, or of a smaller one.
  std::optional<Measured> PlayLong(const std::vector<Measured>& all);

 private:
  std::optional<Measured> Play(unsigned players, const Timetable& times, const char* experiment);

  Bench& m_bench;
  Game m_game;
  double m_planned;
  double m_played = 0;  // s
};

std::optional<Measured> Ladder::Play(unsigned players, const Timetable& times, const char* experiment) {
  const double began = ReadWallTime();
  const auto isStopAsked = [&] {
    const double played = m_played + ReadWallTime() - began;
    m_bench.progress.Show(static_cast<std::size_t>(played), static_cast<std::size_t>(std::max(played, m_planned)));
    return m_bench.progress.IsStopAsked();
  };
  const Party party = PlayParty(m_game, players, times, isStopAsked);
  m_played += ReadWallTime() - began;
  if (m_bench.progress.IsStopAsked()) return std::nullopt;
  if (!party.fault.empty()) {
    m_bench.results.remarks.push_back(FormatLine("%u players: %s", players, party.fault.c_str()));
    return std::nullopt;
  }
  Measured measured = Measure(party);
  nlohmann::ordered_json row{
      {"experiment", experiment}, {"scene", m_game.scene.name}, {"script", m_bench.options.script}};
  row.update(measured.row);
  m_bench.results.rows.push_back(std::move(row));
  m_bench.results.remarks.push_back(measured.line);
  return measured;
}

std::vector<Measured> Ladder::Climb(std::span<const unsigned> counts, const Timetable& times) {
  std::vector<Measured> all;
  for (const unsigned players : counts) {
    const std::optional<Measured> measured = Play(players, times, "count");
    if (!measured) break;
    all.push_back(*measured);
    if (!measured->holds) break;
  }
  return all;
}

std::optional<Measured> Ladder::PlayLong(const std::vector<Measured>& all) {
  m_planned = m_played + FindSeconds({kCounts, 1}, kLongTimes);
  std::optional<Measured> held;
  for (auto each = all.rbegin(); each != all.rend(); ++each) {
    if (!each->holds) continue;
    held = Play(each->players, kLongTimes, "five minutes");
    if (!held || (held->holds && held->overrunShare <= kMostOverruns)) break;
  }
  return held;
}

Series MakeSeries(const char* name, const std::vector<Measured>& all, double Measured::*value, Stroke stroke) {
  Series series{name, stroke, {}};
  for (const Measured& each : all) series.points.push_back({static_cast<double>(each.players), each.*value});
  return series;
}

constexpr const char* kPlayersLabel = "players, a ball of 162 vertices each";

void AddTicksPlot(const std::vector<Measured>& all, Results& results) {
  Plot plot{.name = "capacity_ticks",
            .title = "A tick of the server on one core, bots on another",
            .xLabel = kPlayersLabel,
            .yLabel = "ms",
            .yFromZero = true};
  plot.series.push_back(MakeSeries("p50", all, &Measured::tickMsP50, Stroke::kLineAndPoints));
  plot.series.push_back(MakeSeries("p99", all, &Measured::tickMsP99, Stroke::kLineAndPoints));
  plot.series.push_back(MakeSeries("p99.9", all, &Measured::tickMsP999, Stroke::kLineAndPoints));
  plot.series.push_back(MakeSeries("p99 on the wall", all, &Measured::wallMsP99, Stroke::kDashed));
  const double most = all.back().players;
  plot.series.push_back({"budget", Stroke::kLine, {{0, kTickBudgetMs}, {most, kTickBudgetMs}}});
  results.plots.push_back(std::move(plot));
}

void AddClientsPlot(const std::vector<Measured>& all, Results& results) {
  Plot plot{.name = "capacity_clients",
            .title = "What a player is sent, and how far what is shown is from the truth",
            .xLabel = kPlayersLabel,
            .yLabel = "kbit/s to each",
            .yFromZero = true};
  plot.rightLabel = "displayed error, RMS, % of the body's size";
  plot.series.push_back(MakeSeries("kbit/s", all, &Measured::kbit, Stroke::kLineAndPoints));
  plot.series.push_back(MakeSeries("displayed error", all, &Measured::shownError, Stroke::kDashed));
  plot.series.back().isRight = true;
  results.plots.push_back(std::move(plot));
}

// The largest count that held; otherwise the smallest.
std::optional<Measured> FindBest(const std::vector<Measured>& all) {
  std::optional<Measured> best;
  for (const Measured& each : all) {
    if (each.holds || !best) best = each;
  }
  return best;
}

void AddFigures(const std::optional<Measured>& found, const Options& options, Results& results) {
  const bool isHeld = options.scene == kCapacityScene && options.script == kCapacityScript;
  const bool isAsked = isHeld && !options.quick;
  const unsigned full = HasAvx512() ? kAskedWithAvx512 : kAskedWithAvx2;
  const unsigned asked = options.players.value_or(options.quick ? kQuickPlayers : full);
  results.AddFigureAtLeast("players_at_60hz", found && found->holds ? found->players : 0, asked, isHeld || !found);
  if (!found) return;
  const Measured& best = *found;
  results.AddFigureAtMost("tick_ms_p99", best.tickMsP99, kTickBudgetMs, isAsked);
  results.AddFigureAtMost("overrun_share", best.overrunShare, kMostOverruns, isAsked);
  results.AddFigureAtMost("kbit_per_client", best.kbit, kAskedKbit);
  results.AddFigure("wall_tick_ms_p99", best.wallMsP99);
  results.AddFigure("wall_overrun_share", best.wallOverrunShare);
  for (const char* key : {"receive_ms", "step_ms", "capture_ms", "encode_ms", "send_ms", "displayed_error",
                          "input_to_snapshot_ms_p50", "snapshot_age_ms_p50", "snapshot_age_ms_p99", "speed_median",
                          "touching", "largest_group", "bots_core_share", "late_ms_p99"}) {
    results.AddFigure(key, best.row[key].get<double>());
  }
}

void AddRemarks(Results& results) {
  const Cores cores = ChooseCores();
  results.remarks.push_back(
      "players_at_60hz is judged by the thread time of the server, because other load of its "
      "core is not its own; wall times are given beside it");
  if (cores.server == cores.bots) {
    results.remarks.push_back("there is only one core: the bots took processor time from the server");
  }
}

}  // namespace

void MeasurePlayers(Bench& bench) {
  const Options& options = bench.options;
  AddRemarks(bench.results);
  std::span<const unsigned> counts = kCounts;
  if (options.quick) counts = kQuickCounts;
  if (options.players) counts = {&*options.players, 1};
  const Timetable& times = options.quick ? kQuickTimes : options.players ? kLongTimes : kTimes;
  const bool endsLong = !options.quick && !options.players;
  Ladder ladder(bench, FindSeconds(counts, times) + (endsLong ? FindSeconds({kCounts, 1}, kLongTimes) : 0));
  const std::vector<Measured> all = ladder.Climb(counts, times);
  std::optional<Measured> best = FindBest(all);
  if (endsLong) {
    if (const auto held = ladder.PlayLong(all)) best = held;
  }
  if (bench.progress.IsStopAsked()) return;
  if (all.size() > 1) {
    AddTicksPlot(all, bench.results);
    AddClientsPlot(all, bench.results);
  }
  AddFigures(best, options, bench.results);
}

}  // namespace wobble::bench
