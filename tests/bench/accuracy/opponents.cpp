// The engine against an off-the-shelf ODE solver. Sixteen balls stretched by 20 % for 0.25 s on one thread; each side
// takes its cheapest step that ends within 0.1 % of the radius, RMS, of the reference.
//
// The engine steps by RK4, its default, in float or double, body by body or in lanes as the server does, whichever is
// faster. odeint steps all balls as one state vector, by RK4 in equal steps or by Dormand–Prince with adaptive steps;
// of its tolerances, the one that needs the fewest evaluations counts. It takes the forces either from the laboratory's
// plain equations or from the engine's code in double precision. The fastest of these four is the opponent: where the
// engine's forces are faster, odeint uses them too, and only the rest is compared.
//
// The engine's methods of order 2 have rows, but do not count: on this short undamped problem leap-frog is cheaper than
// RK4, and odeint has symplectic steppers, which are not raced here. Both sides are timed in turns by thread time, and
// the fastest of all rounds counts, so that the effects of other programs on caches and clock rates meet both alike.
#include <algorithm>
#include <cmath>
#include <functional>

#include "server/physics/kernels/kernels.h"
#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/odeint.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kBodies = 16;
constexpr double kAllowed = 1e-3;  // of the radius
constexpr std::int64_t kMostSteps = 1000;
constexpr int kTolerances = 48;  // from 1, eight per decade

struct Racer {
  bool isEngine = false;
  bool isCompared = true;  // counts for the figure
  std::string method;
  std::string forces;    // their source and precision
  double tolerance = 0;  // for adaptive methods
  std::int64_t steps = 0;
  std::function<SolvedMotion(int bodies)> solve;
  SolvedMotion solved{};        // with one body
  double error = 0;             // over the radius
  std::vector<double> times{};  // per round, s

  [[nodiscard]] double FindTime() const { return *std::min_element(times.begin(), times.end()); }
};

class Race {
 public:
  Race() : m_ball(MakeStretchedBall()), m_exact(SolveReference(m_ball)) {}

  // Adds make(steps) with the fewest steps that are accurate enough, trying increasing numbers.
  template <class Make>
  void AddFirstGood(const Make& make) {
    for (std::int64_t steps = 4; steps <= kMostSteps; ++steps) {
      Racer side = make(steps);
      if (!Try(side)) continue;
      m_sides.push_back(std::move(side));
      return;
    }
  }
  // Adds the make(tolerance) that is accurate enough with the fewest evaluations.
  template <class Make>
  void AddCheapest(const Make& make) {
    Racer cheapest;
    for (int i = 0; i < kTolerances; ++i) {
      Racer side = make(std::pow(10, -i / 8.0));
      if (!Try(side)) continue;
      if (!cheapest.solve || side.solved.evaluations < cheapest.solved.evaluations) cheapest = std::move(side);
    }
    if (cheapest.solve) m_sides.push_back(std::move(cheapest));
  }

  // Times all racers once, in turn.
  void Run() {
    for (Racer& side : m_sides) side.times.push_back(side.solve(kBodies).time);
  }

  [[nodiscard]] const Problem& Ball() const { return m_ball; }
  [[nodiscard]] const std::vector<Racer>& Sides() const { return m_sides; }
  // The fastest racer of the engine, or of the opponents.
  [[nodiscard]] const Racer& FindFastest(bool isEngine) const {
    const Racer* fastest = nullptr;
    for (const Racer& side : m_sides) {
      if (side.isEngine != isEngine || !side.isCompared) continue;
      if (fastest == nullptr || side.FindTime() < fastest->FindTime()) fastest = &side;
    }
    return *fastest;
  }

 private:
  bool Try(Racer& side) const {
    side.solved = side.solve(1);
    side.error = FindDistance(side.solved.end.x, m_exact.x) / m_ball.blueprint->size;
    return side.error <= kAllowed;
  }

  Problem m_ball;
  Motion m_exact;
  std::vector<Racer> m_sides;
};

void AddEngine(Race& race) {
  for (const Integrator integrator : {Integrator::kRungeKutta4, Integrator::kVelocityVerlet, Integrator::kLeapFrog}) {
    for (const bool isSingle : {true, false}) {
      race.AddFirstGood([&](std::int64_t steps) {
        const auto solve = [=, &race](int bodies) {
          return SolveInSteps(
              race.Ball(),
              {.integrator = integrator, .steps = steps, .isSingle = isSingle, .bodies = bodies, .isTimed = true});
        };
        return Racer{.isEngine = true,
                     .isCompared = integrator == Integrator::kRungeKutta4,
                     .method = FindName(integrator),
                     .forces = isSingle ? "engine, float" : "engine, double",
                     .steps = steps,
                     .solve = solve};
      });
    }
  }
}

// Lanes, as the server steps bodies without contact pairs.
void AddLanes(Race& race) {
  for (const bool isSingle : {true, false}) {
    race.AddFirstGood([&](std::int64_t steps) {
      const auto solve = [=, &race](int bodies) {
        return SolveInLanes(race.Ball(), {.steps = steps, .isSingle = isSingle, .bodies = bodies});
      };
      return Racer{.isEngine = true,
                   .method = "rk4 in lanes",
                   .forces = isSingle ? "engine, float" : "engine, double",
                   .steps = steps,
                   .solve = solve};
    });
  }
}

void AddOdeint(Race& race) {
  using Method = OdeintSteps::Method;
  for (const bool asksEngine : {false, true}) {
    const std::string forces = asksEngine ? "engine, double" : "laboratory, double";
    const auto make = [&](const OdeintSteps& how) {
      const auto solve = [=, &race](int bodies) {
        OdeintSteps ofBodies = how;
        ofBodies.bodies = bodies;
        return SolveByOdeint(race.Ball(), ofBodies);
      };
      const bool isAdaptive = how.method == Method::kDormandPrince;
      return Racer{.method = FindName(how.method),
                   .forces = forces,
                   .tolerance = isAdaptive ? how.tolerance : 0,
                   .steps = isAdaptive ? 0 : how.steps,
                   .solve = solve};
    };
    race.AddFirstGood([&](std::int64_t steps) {
      return make({.method = Method::kRungeKutta4, .steps = steps, .asksEngine = asksEngine});
    });
    race.AddCheapest([&](double tolerance) {
      return make({.method = Method::kDormandPrince, .tolerance = tolerance, .asksEngine = asksEngine});
    });
  }
}

// The quantile of the values, rounded down to a value.
double FindLowerQuantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void AddRaceRows(Bench& bench, const Race& race, const Racer& opponent) {
  for (const Racer& side : race.Sides()) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < side.times.size(); ++i) ratios.push_back(opponent.times[i] / side.times[i]);
    nlohmann::ordered_json row{{"experiment", "opponents"}, {"method", side.method}, {"forces", side.forces}};
    if (side.tolerance > 0) row["tolerance"] = side.tolerance;
    if (side.steps > 0) row["steps"] = side.steps;
    row["error"] = side.error;
    row["evaluations"] = side.solved.evaluations;
    row["cpu_s"] = side.FindTime();
    row["speedup_vs_odeint"] = opponent.FindTime() / side.FindTime();
    row["speedup_quartiles"] = {FindLowerQuantile(ratios, 0.25), FindLowerQuantile(ratios, 0.5),
                                FindLowerQuantile(ratios, 0.75)};
    bench.results.rows.push_back(std::move(row));
  }
}

}  // namespace

void MeasureOpponents(Bench& bench) {
  Race race;
  AddEngine(race);
  AddLanes(race);
  AddOdeint(race);
  const int rounds = bench.options.quick ? 10 : 100;
  for (int round = 0; round < rounds; ++round) {
    if (bench.progress.IsStopAsked()) return;
    race.Run();
    bench.progress.Show(round + 1, rounds);
  }
  const Racer& opponent = race.FindFastest(false);
  const Racer& engine = race.FindFastest(true);
  AddRaceRows(bench, race, opponent);
  // The limit holds for AVX-512; with half the lanes the figure only informs.
  const double speedup = opponent.FindTime() / engine.FindTime();
  if (FindSweepKernels<float>(kWidestPack).back().width == kWidestPack) {
    bench.results.AddFigureAtLeast("speedup_vs_odeint", speedup, 8);
  } else {
    bench.results.AddFigure("speedup_vs_odeint", speedup);
  }
  bench.results.remarks.push_back("speedup_vs_odeint: " + engine.method + " (" + engine.forces + ") against " +
                                  opponent.method + " (" + opponent.forces + ")");
}

}  // namespace wobble::bench
