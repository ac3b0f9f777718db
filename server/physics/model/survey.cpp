// Coordinates x y z x y z ... are shuffled into one vector an axis; every lane sums its own vertices, and the lanes are
// added up in double precision at the end. The order of every sum is fixed, so the bits do not depend on the machine.
#include "server/physics/model/survey.h"

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

// Values of kLanes vertices, one vector an axis.
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
  const Lanes<float> a = Load(from);
  const Lanes<float> b = Load(from + 8);
  const Lanes<float> c = Load(from + 16);
  const Lanes<float> abX = __builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, -1, -1);
  const Lanes<float> abY = __builtin_shufflevector(a, b, 1, 4, 7, 10, 13, -1, -1, -1);
  const Lanes<float> abZ = __builtin_shufflevector(a, b, 2, 5, 8, 11, 14, -1, -1, -1);
  return {{__builtin_shufflevector(abX, c, 0, 1, 2, 3, 4, 5, 10, 13),
           __builtin_shufflevector(abY, c, 0, 1, 2, 3, 4, 8, 11, 14),
           __builtin_shufflevector(abZ, c, 0, 1, 2, 3, 4, 9, 12, 15)}};
}

Block<double> Split(const double* from) {
  const Lanes<double> a = Load(from);
  const Lanes<double> b = Load(from + 4);
  const Lanes<double> c = Load(from + 8);
  const Lanes<double> abX = __builtin_shufflevector(a, b, 0, 3, 6, -1);
  const Lanes<double> abY = __builtin_shufflevector(a, b, 1, 4, 7, -1);
  const Lanes<double> abZ = __builtin_shufflevector(a, b, 2, 5, -1, -1);
  return {{__builtin_shufflevector(abX, c, 0, 1, 2, 5), __builtin_shufflevector(abY, c, 0, 1, 2, 6),
           __builtin_shufflevector(abZ, c, 0, 1, 4, 7)}};
}

// Calls visit(masses, vectors) block by block. Lanes beyond the last vertex repeat it with mass 0.
template <class Real, class Visit>
void VisitBlocks(std::span<const Real> masses, std::span<const Vector3<Real>> vectors, const Visit& visit) {
  constexpr std::size_t kWidth = kLanes<Real>;
  const std::size_t whole = vectors.size() / kWidth * kWidth;
  for (std::size_t i = 0; i < whole; i += kWidth) visit(Load(&masses[i]), Split(vectors[i].data()));
  if (whole == vectors.size()) return;
  std::array<Real, kWidth> restMasses{};
  std::array<Real, 3 * kWidth> rest;
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    const std::size_t i = std::min(whole + lane, vectors.size() - 1);
    if (whole + lane < vectors.size()) restMasses[lane] = masses[i];
    for (std::size_t axis = 0; axis < 3; ++axis) rest[3 * lane + axis] = vectors[i][static_cast<int>(axis)];
  }
  visit(Load(restMasses.data()), Split(rest.data()));
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

// Sums over vertices, lane by lane.
template <class Real>
struct BulkSums {
  using V = Lanes<Real>;
  Block<Real> weighted{};
  Block<Real> momentum{};
  V mass{};
  V energy{};

  void AddPlaces(const V& m, const Block<Real>& x) {
    for (std::size_t axis = 0; axis < 3; ++axis) weighted.axes[axis] = Fma(m, x.axes[axis], weighted.axes[axis]);
    mass = mass + m;
  }
  // squares: of the speeds, m²/s².
  void AddSpeeds(const V& m, const Block<Real>& v, const V& squares) {
    for (std::size_t axis = 0; axis < 3; ++axis) momentum.axes[axis] = Fma(m, v.axes[axis], momentum.axes[axis]);
    energy = Fma(m, squares, energy);
  }

  [[nodiscard]] BulkMotion FindMotion() const {
    BulkMotion bulk;
    const double all = Sum<Real>(mass);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bulk.centre[static_cast<int>(axis)] = Sum<Real>(weighted.axes[axis]) / all;
      bulk.velocity[static_cast<int>(axis)] = Sum<Real>(momentum.axes[axis]) / all;
    }
    bulk.kineticEnergy = Sum<Real>(energy) / 2;
    return bulk;
  }
};

}  // namespace

template <class Real>
BulkMotion FindBulkMotion(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                          std::span<const Vector3<Real>> v) {
  using V = Lanes<Real>;
  BulkSums<Real> sums;
  VisitBlocks<Real>(masses, x, [&](const V& m, const Block<Real>& block) { sums.AddPlaces(m, block); });
  VisitBlocks<Real>(masses, v,
                    [&](const V& m, const Block<Real>& block) { sums.AddSpeeds(m, block, FindSquares<Real>(block)); });
  return sums.FindMotion();
}

template <class Real>
Survey<Real> MakeSurvey(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                        std::span<const Vector3<Real>> v) {
  using V = Lanes<Real>;
  const V zero = Spread<V>(Real(0));
  Block<Real> low{{Spread<V>(x[0][0]), Spread<V>(x[0][1]), Spread<V>(x[0][2])}};
  Block<Real> high = low;
  BulkSums<Real> sums;
  V fastest = zero;
  VisitBlocks<Real>(masses, x, [&](const V& m, const Block<Real>& block) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low.axes[axis] = Min(low.axes[axis], block.axes[axis]);
      high.axes[axis] = Max(high.axes[axis], block.axes[axis]);
    }
    sums.AddPlaces(m, block);
  });
  VisitBlocks<Real>(masses, v, [&](const V& m, const Block<Real>& block) {
    const V squares = FindSquares<Real>(block);
    sums.AddSpeeds(m, block, squares);
    fastest = Max(fastest, squares);
  });
  Survey<Real> survey;
  survey.bulk = sums.FindMotion();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    survey.bounds.low[static_cast<int>(axis)] = FindLeast<Real>(low.axes[axis]);
    survey.bounds.high[static_cast<int>(axis)] = FindLargest<Real>(high.axes[axis]);
  }
  survey.bounds.speed = std::sqrt(FindLargest<Real>(fastest));

  Block<Real> mean;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    mean.axes[axis] = Spread<V>(static_cast<Real>(survey.bulk.velocity[static_cast<int>(axis)]));
  }
  V farthest = zero;
  VisitBlocks<Real>(masses, v, [&](const V&, const Block<Real>& block) {
    Block<Real> against;
    for (std::size_t axis = 0; axis < 3; ++axis) against.axes[axis] = block.axes[axis] - mean.axes[axis];
    farthest = Max(farthest, FindSquares<Real>(against));
  });
  survey.agitation = std::sqrt(FindLargest<Real>(farthest));
  return survey;
}

#define WOBBLE_INSTANTIATE(Real)                                                                  \
  template BulkMotion FindBulkMotion<Real>(std::span<const Real>, std::span<const Vector3<Real>>, \
                                           std::span<const Vector3<Real>>);                       \
  template Survey<Real> MakeSurvey<Real>(std::span<const Real>, std::span<const Vector3<Real>>,   \
                                         std::span<const Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
