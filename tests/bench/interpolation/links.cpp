// The displayed error for four snapshot rates, three links, linear and Catmull-Rom curves. All watchers of one rate are
// in the same game.
#include <algorithm>

#include "tests/bench/interpolation/experiments.h"
#include "tests/bench/interpolation/showing.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

constexpr int kRates[] = {10, 20, 30, 60};  // Hz
constexpr std::size_t kKnee = 2;            // index into kRates: the default rate
constexpr double kMilliseconds = 1000;

const char* Name(client::Curve curve) { return curve == client::Curve::kLinear ? "linear" : "Catmull-Rom"; }

std::vector<Watcher> ListWatchers() {
  std::vector<Watcher> watchers;
  for (const client::Curve curve : {client::Curve::kCatmullRom, client::Curve::kLinear}) {
    for (const NamedLink& link : ListLinks()) watchers.push_back({link, curve});
  }
  return watchers;
}

void AddRows(const std::vector<Watcher>& watchers, const std::vector<Showing>& showings, Bench& bench) {
  for (std::size_t rate = 0; rate < showings.size(); ++rate) {
    for (std::size_t i = 0; i < watchers.size(); ++i) {
      const Seen& seen = showings[rate].watchers[i];
      bench.results.rows.push_back({{"experiment", "links"},
                                    {"snapshot_hz", kRates[rate]},
                                    {"link", watchers[i].link.name},
                                    {"curve", Name(watchers[i].curve)},
                                    {"displayed_error", seen.error},
                                    {"displayed_error_p99", seen.errorP99},
                                    {"codec_error", showings[rate].codecError},
                                    {"display_delay_ms", kMilliseconds * seen.delay},
                                    {"held_share", seen.heldShare},
                                    {"kbit_per_body", seen.recordKbit},
                                    {"kbit_per_body_sent", seen.sentKbit},
                                    {"disconnected", seen.disconnected}});
    }
  }
}

void AddPlot(const std::vector<Watcher>& watchers, const std::vector<Showing>& showings, Bench& bench) {
  Plot plot{.name = "interpolation_links",
            .title = "What is shown against what was: snapshots 10, 20, 30 and 60 times a second",
            .xLabel = "kbit/s a body, heads of records included",
            .yLabel = "displayed error, RMS, % of the radius",
            .logY = true};
  for (std::size_t i = 0; i < watchers.size(); ++i) {
    const bool isLinear = watchers[i].curve == client::Curve::kLinear;
    Series series{std::string(Name(watchers[i].curve)) + ", " + watchers[i].link.name,
                  isLinear ? Stroke::kDashed : Stroke::kLineAndPoints,
                  {},
                  1 + static_cast<int>(i % ListLinks().size())};
    for (const Showing& showing : showings) {
      series.points.push_back({showing.watchers[i].recordKbit, showing.watchers[i].error});
    }
    plot.series.push_back(std::move(series));
  }
  bench.results.plots.push_back(std::move(plot));
}

void AddFigures(const std::vector<Showing>& showings, bool isQuick, Results& results) {
  const std::vector<Seen>& knee = showings[kKnee].watchers;  // Catmull-Rom first, links in order
  results.AddFigureAtLeast("speed_median", showings[kKnee].speedMedian, 3);
  results.AddFigure("truth_error_of_half", showings[kKnee].truthErrorOfHalf);
  results.AddFigureAtMost("displayed_error_30hz_clean", knee[0].error, 0.4);
  results.AddFigureAtMost("displayed_error_30hz_loss5_jitter20", knee[1].error, 0.45);
  // The violence of a quick run's play varies by a few percent.
  results.AddFigureAtMost("kbit_per_body_30hz", knee[0].recordKbit, 22, !isQuick);
  results.AddFigure("kbit_per_body_30hz_sent", knee[0].sentKbit);
  results.AddFigureAtMost("display_delay_ms_clean", kMilliseconds * knee[0].delay, 120);
  results.AddFigureAtMost("display_delay_ms_jitter", kMilliseconds * knee[1].delay, 150);
  results.AddFigureAtMost("stalls_share", knee[2].heldShare, 0.02);
  double disconnects = 0;
  for (const Showing& showing : showings) {
    disconnects += static_cast<double>(std::count_if(showing.watchers.begin(), showing.watchers.end(),
                                                     [](const Seen& seen) { return seen.disconnected; }));
  }
  results.AddFigureAtMost("disconnects", disconnects, 0);
}

}  // namespace

void MeasureLinks(Bench& bench) {
  const std::vector<Watcher> watchers = ListWatchers();
  std::vector<Showing> showings(std::size(kRates));
  const double seconds = bench.options.quick ? 10 : 120;
  const bool isDone = RunTrials(bench, showings.size(), [&](std::size_t i) {
    showings[i] = PlayShowing(kRates[i], watchers, bench.options.seed, seconds);
  });
  if (!isDone) return;
  AddRows(watchers, showings, bench);
  AddPlot(watchers, showings, bench);
  AddFigures(showings, bench.options.quick, bench.results);
}

}  // namespace wobble::bench
