// Independent of integrator.cpp, which has closed forms for one oscillator: the matrices of the whole body are used
// here, and the closed forms for the first growing motion check both.
#include "tests/bench/stability/modes.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace wobble::bench {
namespace {

using namespace physics;
using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kShift = 1e-6;       // of a coordinate, m, and of a velocity, m/s
constexpr double kRigidShare = 1e-3;  // of the fastest rate: slower rates are rounding of zero
constexpr double kUndamped = 1e-9;    // the same for damping
constexpr double kMarch = 1.1;        // ratio of successive steps in the search for the first unstable one
constexpr int kRadiusBisections = 34;

struct Coordinate {
  std::size_t vertex;
  int axis;
};

std::vector<Coordinate> FindFreeCoordinates(const Coefficients<double>& body) {
  std::vector<Coordinate> free;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool isFixed = std::find(body.fixed.begin(), body.fixed.end(), i) != body.fixed.end();
      if (!isFixed && !(body.planar && axis == 1)) free.push_back({i, axis});
    }
  }
  return free;
}

// −∂a/∂(values); `values` is the x or v that find(a) reads.
template <class Find>
MatrixXd Differentiate(const Equations& equations, const std::vector<Coordinate>& free, std::vector<Vector3d>& values,
                       const Find& find) {
  const std::vector<double>& masses = equations.blueprint->full.masses;
  const auto count = static_cast<Eigen::Index>(free.size());
  MatrixXd matrix(count, count);
  std::vector<Vector3d> ahead(values.size());
  std::vector<Vector3d> behind(values.size());
  for (Eigen::Index column = 0; column < count; ++column) {
    const Coordinate& of = free[static_cast<std::size_t>(column)];
    double& value = values[of.vertex][of.axis];
    const double kept = value;
    value = kept + kShift;
    find(ahead);
    value = kept - kShift;
    find(behind);
    value = kept;
    for (Eigen::Index row = 0; row < count; ++row) {
      const Coordinate& on = free[static_cast<std::size_t>(row)];
      const double slope = (behind[on.vertex][on.axis] - ahead[on.vertex][on.axis]) / (2 * kShift);
      matrix(row, column) = std::sqrt(masses[on.vertex] / masses[of.vertex]) * slope;
    }
  }
  return matrix;
}

std::vector<Complex> FindRates(const MatrixXd& stiffness, const MatrixXd& damping) {
  const Eigen::Index count = stiffness.rows();
  std::vector<Complex> rates;
  if (damping.norm() < kUndamped * std::sqrt(stiffness.norm())) {
    const VectorXd squares = Eigen::SelfAdjointEigenSolver<MatrixXd>(stiffness, Eigen::EigenvaluesOnly).eigenvalues();
    for (const double square : squares) rates.emplace_back(0, std::sqrt(std::max(0.0, square)));
  } else {
    MatrixXd system = MatrixXd::Zero(2 * count, 2 * count);
    system.topRightCorner(count, count).setIdentity();
    system.bottomLeftCorner(count, count) = -stiffness;
    system.bottomRightCorner(count, count) = -damping;
    const Eigen::EigenSolver<MatrixXd> solver(system, false);
    for (const Complex& rate : solver.eigenvalues()) rates.push_back(rate);
  }
  double fastest = 0;
  for (const Complex& rate : rates) fastest = std::max(fastest, std::abs(rate));
  std::erase_if(rates, [&](const Complex& rate) { return std::abs(rate) < kRigidShare * fastest; });
  return rates;
}

// Describes the motion in the null space of a symmetric matrix as an oscillator.
StepLimit DescribeMotion(double step, const MatrixXd& singular, const LinearMotion& motion) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(singular);
  Eigen::Index nearest = 0;
  solver.eigenvalues().cwiseAbs().minCoeff(&nearest);
  const VectorXd x = solver.eigenvectors().col(nearest);
  const double frequency = std::sqrt(x.dot(motion.stiffness * x));
  return {step, frequency, x.dot(motion.damping * x) / (2 * frequency)};
}

double FindFastestRate(const LinearMotion& motion) {
  double fastest = 0;
  for (const Complex& rate : motion.rates) fastest = std::max(fastest, std::abs(rate));
  return fastest;
}

double FindEulerStep(const Complex& rate) {
  const double step = -2 * rate.real() / std::norm(rate);
  return step * std::abs(rate) > kUndamped ? step : 0;
}

double FindRungeKuttaStep(const Complex& rate) {
  double begin = 0;
  double end = 4 / std::abs(rate);
  for (int i = 0; i < kRadiusBisections; ++i) {
    const double middle = (begin + end) / 2;
    const Complex z = middle * rate;
    const Complex growth = 1.0 + z + z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0;
    (std::abs(growth) <= 1 ? begin : end) = middle;
  }
  return begin;
}

template <class FindStep>
StepLimit FindLimitByRates(const LinearMotion& motion, const FindStep& findStep) {
  double smallest = std::numeric_limits<double>::infinity();
  Complex first;
  for (const Complex& rate : motion.rates) {
    const double step = findStep(rate);
    if (step > smallest || (step == smallest && std::abs(rate) < std::abs(first))) continue;
    smallest = step;
    first = rate;
  }
  if (first.imag() != 0) return {smallest, std::abs(first), -first.real() / std::abs(first)};
  const double decay = first.real();
  const MatrixXd identity = MatrixXd::Identity(motion.stiffness.rows(), motion.stiffness.cols());
  return DescribeMotion(smallest, decay * decay * identity + decay * motion.damping + motion.stiffness, motion);
}

// makeMatrix(h) is positive definite while h is stable. Tries increasing steps, because the first unstable one is the
// limit.
template <class MakeMatrix>
StepLimit FindLimitByMatrix(const LinearMotion& motion, const MakeMatrix& makeMatrix) {
  const auto isStable = [&](double h) { return Eigen::LLT<MatrixXd>(makeMatrix(h)).info() == Eigen::Success; };
  double begin = 0.5 / FindFastestRate(motion);
  double end = begin;
  while (isStable(end)) {
    begin = end;
    end *= kMarch;
  }
  for (int i = 0; i < kRadiusBisections; ++i) {
    const double middle = (begin + end) / 2;
    (isStable(middle) ? begin : end) = middle;
  }
  return DescribeMotion(begin, makeMatrix(end), motion);
}

MatrixXd MakeSymplecticMatrix(const LinearMotion& motion, double h) {
  return 4 * MatrixXd::Identity(motion.stiffness.rows(), motion.stiffness.cols()) - h * h * motion.stiffness -
         2 * h * motion.damping;
}

// Returns 1 + D itself where that is no longer positive definite.
MatrixXd MakeVerletMatrix(const LinearMotion& motion, double h) {
  const MatrixXd identity = MatrixXd::Identity(motion.stiffness.rows(), motion.stiffness.cols());
  const MatrixXd d = identity - h / 2 * motion.damping;
  const Eigen::LLT<MatrixXd> sum(identity + d);
  if (sum.info() != Eigen::Success) return identity + d;
  return 4 * sum.solve(identity + d * d) - h * h * motion.stiffness;
}

}  // namespace

LinearMotion Linearise(const Equations& equations, const std::vector<Vector3d>& x, const std::vector<Vector3d>& v) {
  const std::vector<Coordinate> free = FindFreeCoordinates(equations.blueprint->full);
  std::vector<Vector3d> atX = x;
  std::vector<Vector3d> atV = v;
  const auto find = [&](std::vector<Vector3d>& a) { FindAccelerations(equations, atX, atV, a); };
  LinearMotion motion;
  motion.stiffness = Differentiate(equations, free, atX, find);
  motion.damping = Differentiate(equations, free, atV, find);
  return motion;
}

LinearMotion LineariseAtRest(const Blueprint& blueprint) {
  Equations equations;
  equations.blueprint = &blueprint;
  const std::vector<Vector3d> still(blueprint.rest.size(), Vector3d::Zero());
  LinearMotion motion = Linearise(equations, blueprint.rest, still);
  motion.stiffness = (motion.stiffness + motion.stiffness.transpose()).eval() / 2;
  motion.damping = (motion.damping + motion.damping.transpose()).eval() / 2;
  motion.rates = FindRates(motion.stiffness, motion.damping);
  return motion;
}

StepLimit FindStepLimit(Integrator integrator, const LinearMotion& motion) {
  switch (integrator) {
    case Integrator::kRungeKutta4:
      return FindLimitByRates(motion, FindRungeKuttaStep);
    case Integrator::kExplicitEuler:
      return FindLimitByRates(motion, FindEulerStep);
    case Integrator::kVelocityVerlet:
      return FindLimitByMatrix(motion, [&](double h) { return MakeVerletMatrix(motion, h); });
    default:
      return FindLimitByMatrix(motion, [&](double h) { return MakeSymplecticMatrix(motion, h); });
  }
}

}  // namespace wobble::bench
