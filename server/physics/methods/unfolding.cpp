// Corners are computed in double precision, whatever the body's: a folded corner is as likely to be as good as flat,
// where the square root of a float's rounding would be its thickness.
#include "server/physics/methods/unfolding.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/physics/lanes/lanes.h"
#include "server/physics/model/rotation.h"

namespace wobble::physics {
namespace {

// Square of the frequency of all corners together, over the body's: the force has to overcome the springs that hold a
// fold, and more of it needs more substeps. Of the damping rate, over that frequency: critical.
constexpr double kSquareFrequencyRatio = 8;
constexpr double kDampingRatio = 0.7;

struct Corner {
  std::array<std::uint16_t, 4> vertices{};  // its own, then those along x, y, z; planar: the one along y is its own
  std::array<double, 3> signs{};            // by which the edges from the first to the others point along the axes
};

// Calls visit(corner) for each corner of each cell until it returns true; returns whether it did.
template <class Real, class Visit>
bool VisitCorners(const Cells<Real>& cells, const Visit& visit) {
  const bool isPlanar = cells.strides[1] == 0;
  for (const std::uint16_t first : cells.first) {
    for (unsigned bits = 0; bits < 8; ++bits) {
      if (isPlanar && (bits & 2U) != 0) continue;
      Corner corner;
      std::uint32_t own = first;
      for (std::size_t axis = 0; axis < 3; ++axis) own += (bits >> axis & 1U) * cells.strides[axis];
      corner.vertices[0] = static_cast<std::uint16_t>(own);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool isFar = (bits >> axis & 1U) != 0;
        corner.vertices[axis + 1] =
            static_cast<std::uint16_t>(isFar ? own - cells.strides[axis] : own + cells.strides[axis]);
        corner.signs[axis] = isFar ? -1 : 1;
      }
      if (visit(corner)) return true;
    }
  }
  return false;
}

template <class Real>
Columns FindColumns(const Cells<Real>& cells, const Corner& corner, std::span<const Vector3<Real>> x) {
  const Vector3d own = x[corner.vertices[0]].template cast<double>();
  Columns f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector3d along = x[corner.vertices[axis + 1]].template cast<double>() - own;
    f[axis] = corner.signs[axis] * kFoldWeights[axis] / double{cells.edge} * along;
  }
  if (cells.strides[1] == 0) f[1] = Vector3d::UnitY();
  return f;
}

// σ₃ ≥ J / (σ₁ σ₂) ≥ 2 J / Σ F_c·F_c.
bool MayBeFolded(const Columns& f) {
  const double square = f[0].dot(f[0]) + f[1].dot(f[1]) + f[2].dot(f[2]);
  return !(2 * f[0].dot(f[1].cross(f[2])) >= kFoldStretch * square);
}

// −f'.
double FindPull(double stretch) { return std::clamp(kFoldStretch - stretch, 0.0, kMostMissing); }

// Adds −γ m of what v is more than a rigid motion, by so much as the corner is folded, to the pulls on the corner's
// three neighbours. What its own vertex gets is what balances them.
template <class Real>
void AddDamping(const Cells<Real>& cells, const Corner& corner, double share, std::span<const Vector3<Real>> x,
                std::span<const Vector3<Real>> v, std::array<Vector3d, 3>& pulls) {
  const bool isPlanar = cells.strides[1] == 0;
  std::array<Vector3d, 4> places;
  std::array<Vector3d, 4> rates;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (isPlanar && i == 2) continue;
    places[count] = x[corner.vertices[i]].template cast<double>();
    rates[count++] = v[corner.vertices[i]].template cast<double>();
  }
  RemoveRigidMotion({}, std::span(places).first(count), std::span(rates).first(count));
  const double rate = share * double{cells.damping} * double{cells.cornerMass};
  pulls[0] -= rate * rates[1];
  if (!isPlanar) pulls[1] -= rate * rates[2];
  pulls[2] -= rate * rates[count - 1];
}

// The largest part by which an edge along any axis differs from the one of `like` along it, squared.
template <class Real>
Real FindSpread(const Cells<Real>& cells, const Columns& like, std::span<const Vector3<Real>> x) {
  constexpr std::size_t kWidth = 32 / sizeof(Real);
  using V = typename LanesOf<Real, static_cast<int>(kWidth)>::Type;
  const auto load = [](const Real* from) {
    V lanes;
    __builtin_memcpy(&lanes, from, sizeof lanes);
    return lanes;
  };
  const Real* const numbers = x.data()->data();
  V widest = Spread<V>(Real(0));
  Real rest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t stride = 3 * cells.strides[axis];
    if (stride == 0) continue;
    const Real* const isEdge = cells.isEdge[axis].data();
    std::array<Real, 3 * kWidth> wanted;  // x y z x y z ...
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      wanted[i] = cells.edge * static_cast<Real>(like[axis][static_cast<int>(i % 3)]);
    }
    const V parts[] = {load(&wanted[0]), load(&wanted[kWidth]), load(&wanted[2 * kWidth])};
    const std::size_t count = 3 * x.size() - stride;
    std::size_t i = 0;
    for (; i + wanted.size() <= count; i += wanted.size()) {
      for (std::size_t part = 0; part < 3; ++part) {
        const Real* const at = numbers + i + part * kWidth;
        const V off = (load(at + stride) - load(at) - parts[part]) * load(isEdge + i + part * kWidth);
        widest = Max(widest, off * off);
      }
    }
    for (; i < count; ++i) {
      const Real off = (numbers[i + stride] - numbers[i] - wanted[i % 3]) * isEdge[i];
      rest = std::max(rest, off * off);
    }
  }
  for (std::size_t lane = 0; lane < kWidth; ++lane) rest = std::max(rest, widest[lane]);
  return rest;
}

// Whether all cells are so much like the middle one that no corner can be folded: a singular value differs by no more
// than the norm of the difference, which is at most three times its largest part. That of the middle corner is bounded
// by Gershgorin's circles.
template <class Real>
bool AreAlike(const Cells<Real>& cells, std::span<const Vector3<Real>> x) {
  Corner middle;
  middle.vertices[0] = cells.first[cells.first.size() / 2];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle.vertices[axis + 1] = static_cast<std::uint16_t>(middle.vertices[0] + cells.strides[axis]);
    middle.signs[axis] = 1;
  }
  const Columns f = FindColumns(cells, middle, x);
  if (!(f[0].dot(f[1].cross(f[2])) > 0)) return false;
  const double across[] = {std::fabs(f[1].dot(f[2])), std::fabs(f[2].dot(f[0])), std::fabs(f[0].dot(f[1]))};
  double least = f[0].dot(f[0]) - across[1] - across[2];
  least = std::min(least, f[1].dot(f[1]) - across[2] - across[0]);
  least = std::min(least, f[2].dot(f[2]) - across[0] - across[1]);
  const double room = (std::sqrt(std::max(0.0, least)) - kFoldStretch) * double{cells.edge} / 3;
  return room > 0 && double{FindSpread(cells, f, x)} < room * room;
}

// MayBeFolded for any corner of a cell, in the body's precision and without its weights: never false where that is
// true.
template <class Real>
bool MayHoldFolds(const Cells<Real>& cells, std::size_t first, std::span<const Vector3<Real>> x) {
  constexpr Real kSlack = Real(1.1);  // for the weights and for rounding
  const bool isPlanar = cells.strides[1] == 0;
  const Vector3<Real> across = cells.edge * Vector3<Real>::UnitY();
  for (unsigned bits = 0; bits < 8; ++bits) {
    if (isPlanar && (bits & 2U) != 0) continue;
    const std::size_t alongX = first + (bits >> 1U & 1U) * cells.strides[1] + (bits >> 2U) * cells.strides[2];
    const std::size_t alongY = first + (bits & 1U) * cells.strides[0] + (bits >> 2U) * cells.strides[2];
    const std::size_t alongZ = first + (bits & 1U) * cells.strides[0] + (bits >> 1U & 1U) * cells.strides[1];
    const Vector3<Real> a = x[alongX + cells.strides[0]] - x[alongX];
    const Vector3<Real> b = isPlanar ? across : Vector3<Real>(x[alongY + cells.strides[1]] - x[alongY]);
    const Vector3<Real> c = x[alongZ + cells.strides[2]] - x[alongZ];
    const Real square = a.dot(a) + b.dot(b) + c.dot(c);
    if (!(Real(2) * a.dot(b.cross(c)) >= kSlack * static_cast<Real>(kFoldStretch) * cells.edge * square)) return true;
  }
  return false;
}

}  // namespace

template <class Real>
bool HasFolds(const Cells<Real>& cells, std::span<const Vector3<Real>> x) {
  if (AreAlike(cells, x)) return false;
  const auto mayHold = [&](std::uint16_t first) { return MayHoldFolds(cells, first, x); };
  if (std::ranges::none_of(cells.first, mayHold)) return false;
  return VisitCorners(cells, [&](const Corner& corner) {
    const Columns f = FindColumns(cells, corner, x);
    return MayBeFolded(f) && FindStretches(f).values[2] < kFoldStretch;
  });
}

template <class Real>
void AddUnfolding(const Cells<Real>& cells, Real factor, std::span<const Vector3<Real>> x,
                  std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  const double force = double{factor} * double{cells.stiffness} / double{cells.edge};
  VisitCorners(cells, [&](const Corner& corner) {
    const Columns f = FindColumns(cells, corner, x);
    if (!MayBeFolded(f)) return false;
    const Stretches stretches = FindStretches(f);
    const double deepest = FindPull(stretches.values[2]);
    if (!(deepest > 0)) return false;
    std::array<Vector3d, 3> pulls{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    for (std::size_t i = 0; i < 3; ++i) {
      const double pull = force * FindPull(stretches.values[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        pulls[axis] += pull * corner.signs[axis] * kFoldWeights[axis] * stretches.right[i][static_cast<int>(axis)] *
                       stretches.left[i];
      }
    }
    AddDamping(cells, corner, deepest / kMostMissing, x, v, pulls);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector3<Real> pull = pulls[axis].template cast<Real>();
      forces[corner.vertices[axis + 1]] += pull;
      forces[corner.vertices[0]] -= pull;
    }
    return false;
  });
}

double FindFoldStrength(double time) {
  constexpr double kPeriod = 0.4;  // s
  constexpr double kLess = 0.4;
  return std::fmod(time, kPeriod) < kPeriod / 2 ? 1 : kLess;
}

double ComputeFoldEnergy(const Cells<double>& cells, std::span<const Vector3d> x) {
  double energy = 0;
  VisitCorners(cells, [&](const Corner& corner) {
    const Columns f = FindColumns(cells, corner, x);
    if (!MayBeFolded(f)) return false;
    for (const double stretch : FindStretches(f).values) {
      const double pull = FindPull(stretch);
      energy += cells.stiffness * pull * (std::max(0.0, kFoldStretch - stretch) - pull / 2);
    }
    return false;
  });
  return energy;
}

Cells<double> MakeCells(const Blueprint& blueprint, double edge, double cellMass) {
  const GridShape& grid = blueprint.grid;
  const bool isPlanar = grid.rows == 1;
  Cells<double> cells;
  cells.strides = {1, static_cast<std::uint16_t>(isPlanar ? 0 : grid.columns),
                   static_cast<std::uint16_t>(grid.columns * grid.rows)};
  for (std::uint32_t k = 0; k + 1 < grid.layers; ++k) {
    for (std::uint32_t j = 0; j + (isPlanar ? 0 : 1) < grid.rows; ++j) {
      for (std::uint32_t i = 0; i + 1 < grid.columns; ++i) {
        cells.first.push_back(static_cast<std::uint16_t>((k * grid.rows + j) * grid.columns + i));
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells.isEdge[axis].assign(3 * blueprint.rest.size(), 0);
    if (cells.strides[axis] == 0) continue;
    VisitCorners(cells, [&](const Corner& corner) {
      if (corner.signs[axis] > 0) std::fill_n(cells.isEdge[axis].begin() + 3 * corner.vertices[0], 3, 1.0);
      return false;
    });
  }
  // A corner's three edges from one vertex have the stiffness 4 K/a² at most, two edges 3 K/a²; a cell has 8 corners of
  // 4 vertices, or 4 corners of 3.
  cells.edge = edge;
  cells.cornerMass = cellMass / (isPlanar ? 12 : 32);
  cells.squareFrequency = kSquareFrequencyRatio * blueprint.angularFrequency * blueprint.angularFrequency;
  cells.stiffness = cells.squareFrequency * cells.cornerMass * edge * edge / (isPlanar ? 3 : 4);
  cells.damping = kDampingRatio * std::sqrt(cells.squareFrequency);
  return cells;
}

#define WOBBLE_INSTANTIATE(Real)                                                             \
  template bool HasFolds<Real>(const Cells<Real>&, std::span<const Vector3<Real>>);          \
  template void AddUnfolding<Real>(const Cells<Real>&, Real, std::span<const Vector3<Real>>, \
                                   std::span<const Vector3<Real>>, std::span<Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
