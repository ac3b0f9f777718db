// A solid of springs against a shell of springs around a gas, over size: the reason for having gas. A cube with m
// points along each edge has m³ points and a surface of 6m²; a square has m², its outline 4m. So a body of the same
// height and surface resolution costs O(m²) instead of O(m³), in a plane O(m) instead of O(m²).
//
// Sixteen bodies of each kind, side by side in free fall, with four substeps a tick at any size: the masses and springs
// of a vertex stay the same, so no size needs more. The exponents are fitted to all sizes; they deviate from theory by
// the fixed cost per body, which bends the small sizes, and by caches, which bend the large ones.
#include <cmath>

#include "server/physics/shapes/ring.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/throughput/experiments.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr std::size_t kBodiesOfASize = 16;
constexpr int kTicksOfASize = 6;

Blueprint MakeSolid(int cells, bool isPlanar) {
  LatticeDefinition lattice;
  lattice.cells = {cells, isPlanar ? 0 : cells, cells};
  lattice.poissonRatio = FindPoissonRatio(lattice.cells);
  lattice.cellSize = 1.0 / cells;
  const double finer = 4.0 / cells;  // than the default
  lattice.youngModulus *= isPlanar ? 1 : 1 / finer;
  lattice.density /= isPlanar ? finer * finer : finer * finer * finer;
  return MakeLattice(lattice);
}

Blueprint MakeShell(int subdivisions) {
  BallDefinition ball = DescribeBall(subdivisions);
  ball.material.mass *= static_cast<double>(CountVertices(subdivisions)) / static_cast<double>(CountVertices(2));
  return MakeBall(ball);
}

Blueprint MakeOutline(int points) {
  RingDefinition ring;
  ring.material.mass *= static_cast<double>(points) / ring.points;
  ring.points = points;
  return MakeRing(ring);
}

struct Size {
  double edge = 0;  // points along an edge, m
  Blueprint blueprint;
};

struct Kind {
  std::string name;
  std::string key;
  std::vector<Size> sizes;
};

std::vector<Kind> MakeKinds(bool quick) {
  Kind cube{"cube of springs", "lattice_exponent_3d", {}};
  Kind ball{"ball of gas", "gas_exponent_3d", {}};
  // By subdivisions: the cells along an edge of the cube with as many surface points as that icosphere.
  const int cells[] = {0, 3, 5, 10, 20};
  for (int subdivisions = 1; subdivisions <= (quick ? 3 : 4); ++subdivisions) {
    cube.sizes.push_back({cells[subdivisions] + 1.0, MakeSolid(cells[subdivisions], false)});
    const auto vertices = static_cast<double>(CountVertices(subdivisions));
    ball.sizes.push_back({std::sqrt((vertices - 2) / 6) + 1, MakeShell(subdivisions)});
  }
  Kind square{"square of springs", "lattice_exponent_2d", {}};
  Kind ring{"ring of gas", "gas_exponent_2d", {}};
  for (int edge = 8; edge <= (quick ? 32 : 64); edge *= 2) {
    square.sizes.push_back({edge + 1.0, MakeSolid(edge, true)});
    ring.sizes.push_back({edge + 1.0, MakeOutline(4 * edge)});
  }
  return {cube, ball, square, ring};
}

std::unique_ptr<World> MakeFalling(const Blueprint& blueprint) {
  auto world = std::make_unique<World>(FixSubsteps(kTimedSubsteps));
  world->AddBlueprint(blueprint);
  for (std::size_t i = 0; i < kBodiesOfASize; ++i) world->AddBody(0, Vector3d(3 * static_cast<double>(i), 0, 0));
  return world;
}

// Fits y = c x^n; returns n and c.
std::array<double, 2> FitPower(const std::vector<std::array<double, 2>>& points) {
  double sumX = 0;
  double sumY = 0;
  double sumXx = 0;
  double sumXy = 0;
  for (const auto& [x, y] : points) {
    sumX += std::log(x);
    sumY += std::log(y);
    sumXx += std::log(x) * std::log(x);
    sumXy += std::log(x) * std::log(y);
  }
  const auto count = static_cast<double>(points.size());
  const double exponent = (count * sumXy - sumX * sumY) / (count * sumXx - sumX * sumX);
  return {exponent, std::exp((sumY - exponent * sumX) / count)};
}

std::vector<std::array<double, 2>> MeasureKind(Bench& bench, const Kind& kind) {
  std::vector<std::array<double, 2>> points;
  for (const Size& size : kind.sizes) {
    const auto world = MakeFalling(size.blueprint);
    const Replay replay = MakeReplay(*world, world->Settings(), kTicksOfASize);
    Peak peak;
    const TickTimes times = TimeReplays(bench, {&replay, 1}, bench.options.quick ? 2 : 12, peak)[0];
    const double time = times.FindMean() * 1e3 / kBodiesOfASize;
    points.push_back({size.edge, time});
    bench.results.rows.push_back({{"experiment", "sizes"},
                                  {"kind", kind.name},
                                  {"edge", size.edge},
                                  {"vertices", size.blueprint.rest.size()},
                                  {"substeps", CountPlayed(*world, world->Settings(), 1).substeps},
                                  {"ms_per_tick", time},
                                  {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
    if (bench.progress.IsStopAsked()) break;
  }
  return points;
}

}  // namespace

void MeasureSizes(Bench& bench) {
  Plot plot{.name = "throughput_sizes",
            .title = "A tick of one body, four substeps: springs through and through against a skin round a gas",
            .xLabel = "m, points along an edge of the body",
            .yLabel = "ms a tick",
            .logX = true,
            .logY = true};
  int colour = 0;
  for (const Kind& kind : MakeKinds(bench.options.quick)) {
    if (bench.progress.IsStopAsked()) return;
    const auto points = MeasureKind(bench, kind);
    const auto [exponent, factor] = FitPower(points);
    Series fit{FormatLine("%s: m^%.2f", kind.name.c_str(), exponent), Stroke::kLine, {}, ++colour};
    for (const auto& [x, y] : points) fit.points.push_back({x, factor * std::pow(x, exponent)});
    plot.series.push_back(std::move(fit));
    plot.series.push_back({"", Stroke::kRings, points, colour});
    bench.results.AddFigure(kind.key, exponent);
  }
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace wobble::bench
