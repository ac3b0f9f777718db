// Bits against error: our codec and the others on the same frames of the fixed play. Bits are compared at equal error,
// interpolated on each curve; of an opponent with variants, the one with the fewest bits there counts.
#include <algorithm>

#include "tests/bench/codec/curve.h"
#include "tests/bench/codec/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

// Grid steps as a share of the body's size. The RMS rounding error over vertices is half a step.
std::vector<double> ListSteps(bool isQuick) {
  if (isQuick) return {0.024, 0.011, 0.005, 0.002, 0.0006};
  return {0.03, 0.02, 0.014, 0.01, 0.007, 0.005, 0.0035, 0.0024, 0.0016, 0.001, 0.0006};
}

// Finer than any grid here: the curve must reach the error of Rigs of Rods' half floats.
constexpr double kFinestTarget = 0.0002;

std::vector<double> ListDracoBits(bool isQuick) {
  if (isQuick) return {7, 8, 9, 10, 11};
  return {6, 7, 8, 9, 10, 11, 12, 13};
}

struct Opponent {
  const char* ratioKey;
  double ratio;  // required ratio; 0: informative only
  std::vector<Method> variants;
};

std::vector<Opponent> ListOpponents() {
  return {
      {"ratio_vs_draco", 5, {MakeDracoMesh(), MakeDracoPoints()}},
      {"ratio_vs_meshopt_zstd", 6, {MakeMeshoptimizer(false)}},
      {"ratio_vs_delta_zstd", 5, {MakeDeltaZstd(false)}},
      // Not the original method, but our own best configuration of it.
      {"ratio_vs_meshopt_delta_zstd", 0, {MakeMeshoptimizer(true)}},
      {"ratio_vs_tuned_delta_zstd", 0, {MakeDeltaZstd(true)}},
      {"ratio_vs_delta_acknowledged", 0, {MakeDeltaAcknowledged()}},
  };
}

// The points of one method; every point of every method is a separate trial.
struct Sweep {
  Method method;
  Curve curve;
};

void Fill(std::vector<Sweep>& sweeps, const Recording& recording, Bench& bench) {
  struct Place {
    std::size_t sweep, point;
  };
  std::vector<Place> places;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    sweeps[i].curve.resize(sweeps[i].method.parameters.size());
    for (std::size_t j = 0; j < sweeps[i].curve.size(); ++j) places.push_back({i, j});
  }
  RunTrials(bench, places.size(), [&](std::size_t i) {
    Sweep& sweep = sweeps[places[i].sweep];
    sweep.curve[places[i].point] = MeasurePoint(recording, sweep.method, sweep.method.parameters[places[i].point]);
  });
}

void AddRows(const std::vector<Sweep>& sweeps, Bench& bench) {
  for (const Sweep& sweep : sweeps) {
    for (const RatePoint& point : sweep.curve) {
      bench.results.rows.push_back({{"experiment", "curves"},
                                    {"method", sweep.method.name},
                                    {"parameter", point.parameter},
                                    {"bits_per_vertex", point.bitsPerVertex},
                                    {"error_percent", point.errorPercent},
                                    {"error_percent_p999", point.errorPercentP999}});
    }
  }
}

void AddPlot(const std::vector<Sweep>& sweeps, Bench& bench) {
  Plot plot{.name = "codec_curves",
            .title = "Four balls of 162 vertices in violent play: what a vertex costs",
            .xLabel = "RMS error, % of the radius",
            .yLabel = "bits a vertex, heads of records included",
            .logX = true};
  for (const Sweep& sweep : sweeps) {
    // Our variants share one colour, because the others are more than the seven colours that can be told apart.
    const std::size_t number = plot.series.size();
    const bool isOurs = sweep.method.name.rfind("ours", 0) == 0;
    const bool isDashed = number >= 8;
    const Stroke line = isDashed ? Stroke::kDashed : Stroke::kLineAndPoints;
    Series series{sweep.method.name, sweep.curve.size() > 1 ? line : Stroke::kRings, {}};
    series.colour = isOurs ? 1 : 2 + static_cast<int>((number + 6) % 7);
    for (const RatePoint& point : sweep.curve) series.points.push_back({point.errorPercent, point.bitsPerVertex});
    plot.series.push_back(std::move(series));
  }
  bench.results.plots.push_back(std::move(plot));
}

void AddPlayFigures(const Recording& recording, Results& results) {
  results.AddFigureAtLeast("speed_median", FindMedian(recording.speeds), 3);
  results.AddFigureAtLeast("deformation_median", 100 * FindMedian(recording.deformations), 3);
  results.remarks.push_back(
      FormatLine("play: %zu frames of 4 balls, 162 vertices, radius 1 m; deformation_median: RMS departure from the "
                 "best rigid fit, "
                 "%% of the radius; bits include heads of records, not of packets",
                 recording.frames.size()));
}

void AddBasisFigure(Results& results) {
  std::size_t most = 0;
  for (const auto& basis : TrainBasesAsServer(MakePlayedBall())) most = std::max(most, basis.size());
  results.AddFigureAtMost("basis_kb", static_cast<double>(most) / 1024, 64);
}

}  // namespace

void MeasureCurves(Bench& bench) {
  const bool isQuick = bench.options.quick;
  const Recording recording = RecordBalls(Pattern::kChase, bench.options.seed, isQuick ? 20 : 60);
  AddPlayFigures(recording, bench.results);
  AddBasisFigure(bench.results);
  const std::vector<Opponent> opponents = ListOpponents();
  std::vector<Sweep> sweeps{{MakeOurs(), {}}, {MakeRigsOfRods(), {}}};
  for (const double step : ListSteps(isQuick)) sweeps[0].method.parameters.push_back(step / 2);
  sweeps[0].method.parameters.push_back(kFinestTarget);
  for (const Opponent& opponent : opponents) {
    for (const Method& variant : opponent.variants) {
      sweeps.push_back({variant, {}});
      sweeps.back().method.parameters = variant.parameters.empty() ? ListSteps(isQuick) : ListDracoBits(isQuick);
    }
  }
  for (const Without without : {Without::kBasis, Without::kSurfaces}) {
    sweeps.push_back({MakeOurs(without), {}});
    sweeps.back().method.parameters = sweeps[0].method.parameters;
  }
  Fill(sweeps, recording, bench);
  if (bench.progress.IsStopAsked()) return;
  AddRows(sweeps, bench);
  AddPlot(sweeps, bench);

  Results& results = bench.results;
  const Curve& ours = sweeps[0].curve;
  // A quick run is a third as long, and its play varies in violence by a few percent; only the ratios are enforced
  // there.
  results.AddFigureAtMost("bits_per_vertex_01", FindBitsAt(ours, 0.1), 8, !isQuick);
  results.AddFigureAtMost("bits_per_vertex_025", FindBitsAt(ours, 0.25), 4.5, !isQuick);
  results.AddFigureAtMost("bits_per_vertex_05", FindBitsAt(ours, 0.5), 2.4, !isQuick);
  const RatePoint& rigs = sweeps[1].curve.front();
  results.AddFigureAtLeast("ratio_vs_rigs_of_rods", rigs.bitsPerVertex / FindBitsAt(ours, rigs.errorPercent), 4,
                           !isQuick);
  std::size_t next = 2;
  for (const Opponent& opponent : opponents) {
    std::vector<Curve> curves;
    for (std::size_t i = 0; i < opponent.variants.size(); ++i) curves.push_back(sweeps[next++].curve);
    const double ratio = FindFewestBitsAt(curves, 0.25) / FindBitsAt(ours, 0.25);
    results.AddFigureAtLeast(opponent.ratioKey, ratio, opponent.ratio, opponent.ratio > 0);
  }
  for (const char* const key : {"ratio_without_basis", "ratio_without_surfaces"}) {
    results.AddFigure(key, FindBitsAt(sweeps[next++].curve, 0.25) / FindBitsAt(ours, 0.25));
  }
  const RatePoint setting = MeasurePoint(recording, sweeps[0].method, 0.0025);
  results.AddFigureAtMost("vertex_error_p999_025", setting.errorPercentP999, 1);
}

}  // namespace wobble::bench
