// Compares the contact laws. A ball falls on a plane under the default law, under the magnetic law with four strengths,
// and under backtracking; its mean height over time is plotted side by side.
//
// There is no limit to keep, because the laws differ by design. A magnetic ground conserves energy and yields over a
// distance of √(K/N) per vertex, so rows give the height at which the ball hovers, its final oscillation, its first
// bounce relative to the default law, and the cost of a tick. bounce.cpp checks the magnetic bounces against fine
// steps.
#include <algorithm>
#include <cmath>

#include "server/physics/shapes/finish_blueprint.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kFall = 3;       // of the lowest vertex, m; the strongest magnet carries the ball at half of it
constexpr double kDuration = 20;  // s
constexpr double kRest = 2;       // at the end of kDuration, s

struct RestingBody {
  std::string law;
  double strength = 0;  // magnetic: K, N·m²
  Blueprint blueprint;
  std::vector<std::array<double, 2>> heights;  // mean over the body at the tick's end, m
  double lowest = 0;                           // of any vertex at any tick, m
  std::uint64_t substeps = 0;                  // of all ticks
  std::uint64_t mostSubsteps = 0;              // of one tick
};

void PlayRestingBody(RestingBody& each) {
  World world(WorldSettings{});
  world.AddBlueprint(each.blueprint);
  world.AddObstacle(Obstacle{});
  double touching = 0;
  for (const Vector3d& x : each.blueprint.rest) touching = std::max(touching, -x.z());
  world.AddBody(0, Vector3d(0, 0, touching + kFall));
  const Body& body = world.Bodies()[0];
  each.lowest = kFall;
  for (int tick = 1; tick <= std::lround(kDuration / kContactTick); ++tick) {
    const std::uint64_t substeps = world.Step().allSubsteps;
    each.substeps += substeps;
    each.mostSubsteps = std::max(each.mostSubsteps, substeps);
    each.heights.push_back({tick * kContactTick, world.FindCentre(body).z()});
    VisitVertices(body, [&](std::size_t, const Vector3d& p) { each.lowest = std::min(each.lowest, p.z()); });
  }
}

// Height of the first top, m; of the last sample where it never rises.
double FindFirstTop(const std::vector<std::array<double, 2>>& heights) {
  std::size_t i = 1;
  while (i < heights.size() && heights[i][1] <= heights[i - 1][1]) ++i;
  while (i < heights.size() && heights[i][1] >= heights[i - 1][1]) ++i;
  return heights[i - 1][1];
}

std::vector<RestingBody> MakeRestingBodies() {
  std::vector<RestingBody> cases;
  const Blueprint ball = MakeBall(DescribeBall(2));
  const auto add = [&](const char* name, ContactLaw law, double strength) {
    RestingBody& each = cases.emplace_back();
    each.law = name;
    each.strength = strength;
    each.blueprint = ball;
    if (law == ContactLaw::kMagnetic) SetContactLaw(each.blueprint, law, strength);
    if (law == ContactLaw::kBacktracking) SetContactLaw(each.blueprint, law);
  };
  add("penalty", ContactLaw::kPenalty, 0);
  for (const double strength : {1.0, 1e-1, 1e-2, 1e-4}) add("magnetic", ContactLaw::kMagnetic, strength);
  add("backtracking", ContactLaw::kBacktracking, 0);
  return cases;
}

std::string FindName(const RestingBody& each) {
  if (each.strength == 0) return each.law;
  char name[48];
  std::snprintf(name, sizeof name, "%s, K = %g", each.law.c_str(), each.strength);
  return name;
}

}  // namespace

void MeasureLaws(Bench& bench) {
  std::vector<RestingBody> cases = MakeRestingBodies();
  if (!RunTrials(bench, cases.size(), [&](std::size_t i) { PlayRestingBody(cases[i]); })) return;
  Plot plot{.name = "laws",
            .title = "A ball of 162 vertices dropped from 3 m",
            .xLabel = "time, s",
            .yLabel = "mean height, m"};
  const double defaultTop = FindFirstTop(cases[0].heights);
  for (const RestingBody& each : cases) {
    const std::size_t from = each.heights.size() - static_cast<std::size_t>(std::lround(kRest / kContactTick));
    double sum = 0;
    double least = each.heights.back()[1];
    double most = least;
    for (std::size_t i = from; i < each.heights.size(); ++i) {
      sum += each.heights[i][1];
      least = std::min(least, each.heights[i][1]);
      most = std::max(most, each.heights[i][1]);
    }
    const double top = FindFirstTop(each.heights);
    bench.results.rows.push_back(
        {{"experiment", "laws"},
         {"law", each.law},
         {"strength", each.strength},
         {"rest_height", sum / static_cast<double>(each.heights.size() - from)},
         {"amplitude_left", (most - least) / 2},
         {"lowest_vertex", each.lowest},
         {"first_top", top},
         {"first_top_against_penalty", top / defaultTop},
         {"substeps_per_tick", static_cast<double>(each.substeps) / static_cast<double>(each.heights.size())},
         {"most_substeps", each.mostSubsteps}});
    plot.series.push_back({FindName(each), Stroke::kLine, each.heights});
  }
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace wobble::bench
