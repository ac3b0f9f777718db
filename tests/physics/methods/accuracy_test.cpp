// Order of convergence of the integrator, on problems with an analytic solution, away from contact.
#include <gtest/gtest.h>

#include <cmath>

#include "server/physics/methods/runge_kutta.h"

namespace wobble::physics {
namespace {

// x'' = −ω²x − g x', x(0) = 1, x'(0) = 0, by RK4 with `steps` steps over one second.
double MeasureOscillatorError(double omega, double damping, int steps) {
  std::vector<Vector3d> x{Vector3d(1, 0, 0)};
  std::vector<Vector3d> v{Vector3d::Zero()};
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    a[0] = -omega * omega * at[0] - damping * speed[0];
  };
  for (int i = 0; i < steps; ++i) {
    StepRungeKutta<double>(kClassicRungeKutta, 1.0 / steps, accelerate, std::span(x), std::span(v), buffers);
  }
  const double half = damping / 2;
  const double ringing = std::sqrt(omega * omega - half * half);
  const double exactX = std::exp(-half) * (std::cos(ringing) + half / ringing * std::sin(ringing));
  const double exactV = -std::exp(-half) * omega * omega / ringing * std::sin(ringing);
  return std::hypot(x[0].x() - exactX, (v[0].x() - exactV) / omega);
}

class OrderTest : public testing::TestWithParam<double> {};

TEST_P(OrderTest, IsFour) {
  const double damping = GetParam();
  const double coarse = MeasureOscillatorError(10, damping, 100);
  const double fine = MeasureOscillatorError(10, damping, 800);
  const double order = std::log(coarse / fine) / std::log(8.0);
  EXPECT_GT(order, 3.9) << "errors " << coarse << ", " << fine;
  EXPECT_LT(order, 4.1) << "errors " << coarse << ", " << fine;
}
INSTANTIATE_TEST_SUITE_P(Damping, OrderTest, testing::Values(0.0, 1.0, 5.0));

TEST(RungeKutta, FollowsFreeFallExactly) {
  std::vector<Vector3d> x{Vector3d(0, 0, 100)};
  std::vector<Vector3d> v{Vector3d(3, 0, 2)};
  StageBuffers<double, 4> buffers;
  const auto accelerate = [](std::span<const Vector3d>, std::span<const Vector3d>, std::span<Vector3d> a) {
    a[0] = Vector3d(0, 0, -9.81);
  };
  for (int i = 0; i < 120; ++i) {
    StepRungeKutta<double>(kClassicRungeKutta, 1.0 / 60, accelerate, std::span(x), std::span(v), buffers);
  }
  EXPECT_NEAR(x[0].x(), 6, 1e-12);
  EXPECT_NEAR(x[0].z(), 100 + 2 * 2 - 0.5 * 9.81 * 4, 1e-11);
}

// StepRungeKutta takes any explicit tableau: Heun's method must show order 2.
TEST(RungeKutta, TakesAnotherTableau) {
  constexpr ButcherTableau<2> kHeun{.a = {{{0, 0}, {1, 0}}}, .b = {0.5, 0.5}};
  const auto measure = [&](int steps) {
    std::vector<Vector3d> x{Vector3d(1, 0, 0)};
    std::vector<Vector3d> v{Vector3d::Zero()};
    StageBuffers<double, 2> buffers;
    const auto accelerate = [](std::span<const Vector3d> at, std::span<const Vector3d>, std::span<Vector3d> a) {
      a[0] = -100 * at[0];
    };
    for (int i = 0; i < steps; ++i) {
      StepRungeKutta<double>(kHeun, 1.0 / steps, accelerate, std::span(x), std::span(v), buffers);
    }
    return std::fabs(x[0].x() - std::cos(10.0));
  };
  EXPECT_NEAR(std::log(measure(1000) / measure(8000)) / std::log(8.0), 2, 0.1);
}

// A float oscillator far from the origin of its coordinates must not gain energy: the increment form rounds without
// bias.
TEST(RungeKutta, KeepsFloatOscillatorsCalm) {
  std::vector<Vector3f> x{Vector3f(1.01F, 0, 0)};
  std::vector<Vector3f> v{Vector3f::Zero()};
  StageBuffers<float, 4> buffers;
  const auto accelerate = [](std::span<const Vector3f> at, std::span<const Vector3f>, std::span<Vector3f> a) {
    a[0] = -900.0F * (at[0] - Vector3f(1, 0, 0));
  };
  for (int i = 0; i < 36000; ++i) {
    StepRungeKutta<float>(kClassicRungeKutta, 1.0F / 960, accelerate, std::span(x), std::span(v), buffers);
  }
  const double energy = 0.5 * double{v[0].squaredNorm()} + 450 * double{(x[0] - Vector3f(1, 0, 0)).squaredNorm()};
  EXPECT_LT(energy, 1.02 * 450 * 1e-4);
  EXPECT_GT(energy, 0.9 * 450 * 1e-4);
}

}  // namespace
}  // namespace wobble::physics
