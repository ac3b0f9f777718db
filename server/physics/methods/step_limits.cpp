// Each limit by its closed form, or by bisection of the condition where that is simpler. w2 = w², 1/s²; g in 1/s.
#include "server/physics/methods/step_limits.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "server/physics/methods/stability.h"

namespace wobble::physics {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr int kBisections = 60;  // from an interval as large as the limit down to the limit's last bit

// The step in [0, end] up to which isStable(step) holds.
template <class IsStable>
double Bisect(double end, const IsStable& isStable) {
  double begin = 0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = (begin + end) / 2;
    (isStable(middle) ? begin : end) = middle;
  }
  return begin;
}

// While the mode rings |1 + hλ|² = 1 − hg + h²w² < 1; once it is overdamped 1 − hμ > −1 for the faster root μ.
double FindExplicitEulerStep(double w2, double g) {
  const double discriminant = g * g / 4 - w2;
  return discriminant <= 0 ? g / w2 : 2 / (g / 2 + std::sqrt(discriminant));
}

// h²w² + 2hg = 4, solved without the cancellation of the textbook form.
double FindSymplecticStep(double w2, double g) { return 4 / (g + std::sqrt(g * g + 4 * w2)); }

// The first root of the cubic f(h) = h²w²(2 − hg/2) − 4(2 − hg + h²g²/4), which rises from −8 to its one maximum and
// then falls. Where the maximum is below 0, or beyond 4/g, the limit is hg < 4.
double FindVerletStep(double w2, double g) {
  if (!(g > 0)) return 2 / std::sqrt(w2);
  const auto f = [&](double h) { return h * h * w2 * (2 - h * g / 2) - 4 * (2 - h * g + h * h * g * g / 4); };
  const double slope = 2 * w2 - g * g;
  // The positive root of f' = 4g + 2·slope·h − (3/2) w² g h².
  const double top = w2 > 0 ? (slope + std::sqrt(slope * slope + 6 * w2 * g * g)) / (1.5 * w2 * g) : kForever;
  const double end = std::min(top, 4 / g);
  return f(end) > 0 ? Bisect(end, [&](double h) { return f(h) < 0; }) : 4 / g;
}

// The limit of a body whose fastest mode this is. Dashpots damp its slower modes by γ = βω² with the same β = g/w², so
// with d = hγ the limit is h < β (16/(d (4 − d)) − 2): narrowest at d = 2, where h < 2β, and wider beyond. So a fast
// mode that is damped past d = 2 is stable in steps, up to d = 4, in which a slower mode is not. β is reduced by the 5
// % that the frequency has as a margin.
double FindVerletStepOfBody(double w2, double g) {
  const double step = FindVerletStep(w2, g);
  return g * step > 2 ? std::min(step, std::max(2 / g, 1.9 * g / w2)) : step;
}

double FindRungeKuttaStep(double w2, double g) {
  using Complex = std::complex<double>;
  const Complex root = std::sqrt(Complex(g * g / 4 - w2));
  const auto grows = [](const Complex& m) {
    return std::abs(1.0 + m * (1.0 + m / 2.0 * (1.0 + m / 3.0 * (1.0 + m / 4.0)))) > 1;
  };
  const auto isStable = [&](double h) { return !grows(h * (-g / 2 + root)) && !grows(h * (-g / 2 - root)); };
  return Bisect(4 / FindModeRate(w2, g), isStable);
}

}  // namespace

double FindLargestStep(Integrator integrator, double squareFrequency, double dampingRate) {
  if (!(squareFrequency > 0) && !(dampingRate > 0)) return kForever;
  switch (integrator) {
    case Integrator::kRungeKutta4:
      return FindRungeKuttaStep(squareFrequency, dampingRate);
    case Integrator::kExplicitEuler:
      return FindExplicitEulerStep(squareFrequency, dampingRate);
    case Integrator::kSemiImplicitEuler:
    case Integrator::kLeapFrog:
    case Integrator::kPositionVerlet:
      return FindSymplecticStep(squareFrequency, dampingRate);
    case Integrator::kVelocityVerlet:
      return FindVerletStep(squareFrequency, dampingRate);
    case Integrator::kImplicitEuler:
      break;
  }
  return kForever;
}

double FindStableRate(Integrator integrator, double squareFrequency, double dampingRate) {
  if (integrator == Integrator::kRungeKutta4) {
    const double rate = FindModeRate(squareFrequency, dampingRate);
    const bool lightlyDamped = dampingRate < rate * 2 / 3;  // g = 2ζω: under a third of critical
    return rate / (lightlyDamped ? kStabilityLimitLightlyDamped : kStabilityLimit);
  }
  if (integrator == Integrator::kVelocityVerlet) return 1 / FindVerletStepOfBody(squareFrequency, dampingRate);
  if (integrator == Integrator::kExplicitEuler) integrator = Integrator::kSemiImplicitEuler;
  return 1 / FindLargestStep(integrator, squareFrequency, dampingRate);
}

}  // namespace wobble::physics
