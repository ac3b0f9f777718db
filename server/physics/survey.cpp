#include "server/physics/survey.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/physics/lanes/lanes.h"

namespace wobble::physics {
namespace {

template <class Real>
inline constexpr int kLanes = 32 / sizeof(Real);
template <class Real>
using Lanes = typename LanesOf<Real, kLanes<Real>>::Type;

// Values of as many vertices as there are lanes, axis by axis.
template <class Real>
struct Block {
  Lanes<Real> axes[3];
};

template <class Real>
Lanes<Real> Load(const Real* from) {
  Lanes<Real> lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

Block<float> Split(const float* from) {
  const __m256 a = Load(from);
  const __m256 b = Load(from + 8);
  const __m256 c = Load(from + 16);
  const __m256 abX = __builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, -1, -1);
  const __m256 abY = __builtin_shufflevector(a, b, 1, 4, 7, 10, 13, -1, -1, -1);
  const __m256 abZ = __builtin_shufflevector(a, b, 2, 5, 8, 11, 14, -1, -1, -1);
  return {{__builtin_shufflevector(abX, c, 0, 1, 2, 3, 4, 5, 10, 13),
           __builtin_shufflevector(abY, c, 0, 1, 2, 3, 4, 8, 11, 14),
           __builtin_shufflevector(abZ, c, 0, 1, 2, 3, 4, 9, 12, 15)}};
}

Block<double> Split(const double* from) {
  const __m256d a = Load(from);
  const __m256d b = Load(from + 4);
  const __m256d c = Load(from + 8);
  const __m256d abX = __builtin_shufflevector(a, b, 0, 3, 6, -1);
  const __m256d abY = __builtin_shufflevector(a, b, 1, 4, 7, -1);
  const __m256d abZ = __builtin_shufflevector(a, b, 2, 5, -1, -1);
  return {{__builtin_shufflevector(abX, c, 0, 1, 2, 5), __builtin_shufflevector(abY, c, 0, 1, 2, 6),
           __builtin_shufflevector(abZ, c, 0, 1, 4, 7)}};
}

// Calls visit(masses, x, v) block by block. Lanes beyond the last vertex repeat it without mass.
template <class Real, class Visit>
void VisitBlocks(std::span<const Real> masses, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                 const Visit& visit) {
  constexpr std::size_t kWidth = kLanes<Real>;
  const std::size_t whole = x.size() / kWidth * kWidth;
  for (std::size_t i = 0; i < whole; i += kWidth) visit(Load(&masses[i]), Split(x[i].data()), Split(v[i].data()));
  if (whole == x.size()) return;
  std::array<Real, kWidth> restMasses{};
  std::array<Real, 3 * kWidth> restX;
  std::array<Real, 3 * kWidth> restV;
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    const std::size_t i = std::min(whole + lane, x.size() - 1);
    if (whole + lane < x.size()) restMasses[lane] = masses[i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      restX[3 * lane + axis] = x[i][static_cast<int>(axis)];
      restV[3 * lane + axis] = v[i][static_cast<int>(axis)];
    }
  }
  visit(Load(restMasses.data()), Split(restX.data()), Split(restV.data()));
}

template <class Real>
double Sum(const Lanes<Real>& lanes) {
  double sum = 0;
  for (int lane = 0; lane < kLanes<Real>; ++lane) sum += double{lanes[lane]};
  return sum;
}
template <class Real>
Real FindLeast(const Lanes<Real>& lanes) {
  Real least = lanes[0];
  for (int lane = 1; lane < kLanes<Real>; ++lane) least = std::min(least, lanes[lane]);
  return least;
}
template <class Real>
Real FindLargest(const Lanes<Real>& lanes) {
  Real largest = lanes[0];
  for (int lane = 1; lane < kLanes<Real>; ++lane) largest = std::max(largest, lanes[lane]);
  return largest;
}

template <class Real>
Lanes<Real> FindSquares(const Block<Real>& block) {
  return Fma(block.axes[2], block.axes[2], Fma(block.axes[1], block.axes[1], block.axes[0] * block.axes[0]));
}

}  // namespace

template <class Real>
Survey<Real> MakeSurvey(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                        std::span<const Vector3<Real>> v) {
  using V = Lanes<Real>;
  const V zero = Spread<V>(Real(0));
  Block<Real> low{{Spread<V>(x[0][0]), Spread<V>(x[0][1]), Spread<V>(x[0][2])}};
  Block<Real> high = low;
  Block<Real> weighted{{zero, zero, zero}};
  Block<Real> momentum = weighted;
  V mass = zero;
  V energy = zero;
  V fastest = zero;
  VisitBlocks<Real>(masses, x, v, [&](const V& m, const Block<Real>& atX, const Block<Real>& atV) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low.axes[axis] = Min(low.axes[axis], atX.axes[axis]);
      high.axes[axis] = Max(high.axes[axis], atX.axes[axis]);
      weighted.axes[axis] = Fma(m, atX.axes[axis], weighted.axes[axis]);
      momentum.axes[axis] = Fma(m, atV.axes[axis], momentum.axes[axis]);
    }
    const V square = FindSquares<Real>(atV);
    mass = mass + m;
    energy = Fma(m, square, energy);
    fastest = Max(fastest, square);
  });
  Survey<Real> survey;
  const double all = Sum<Real>(mass);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<int>(axis);
    survey.bounds.low[k] = FindLeast<Real>(low.axes[axis]);
    survey.bounds.high[k] = FindLargest<Real>(high.axes[axis]);
    survey.centre[k] = Sum<Real>(weighted.axes[axis]) / all;
    survey.velocity[k] = Sum<Real>(momentum.axes[axis]) / all;
  }
  survey.bounds.speed = std::sqrt(FindLargest<Real>(fastest));
  survey.kineticEnergy = Sum<Real>(energy) / 2;

  V farthest = zero;
  VisitBlocks<Real>(masses, x, v, [&](const V&, const Block<Real>&, const Block<Real>& atV) {
    Block<Real> against;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      against.axes[axis] = atV.axes[axis] - Spread<V>(static_cast<Real>(survey.velocity[static_cast<int>(axis)]));
    }
    farthest = Max(farthest, FindSquares<Real>(against));
  });
  survey.agitation = std::sqrt(FindLargest<Real>(farthest));
  return survey;
}

template Survey<float> MakeSurvey<float>(std::span<const float>, std::span<const Vector3<float>>,
                                         std::span<const Vector3<float>>);
template Survey<double> MakeSurvey<double>(std::span<const double>, std::span<const Vector3<double>>,
                                           std::span<const Vector3<double>>);

}  // namespace wobble::physics
