// A quadratic B-spline in each direction: the lowest degree whose normals turn without a jump; a point reads nine
// controls. The controls are computed once, by a recursion along each row and column, such that the surface goes
// through the given heights (Unser, Aldroubi & Eden 1993, "B-spline signal processing").
//
// Rejected: Catmull-Rom goes through the heights by itself, but reads sixteen, overshoots more and has no bound of its
// slope that could be read off; bilinear patches have a crease along every cell, on which resting bodies rattle.
#include "server/physics/contact/height_field.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "server/physics/model/roots.h"

namespace wobble::physics {
namespace {

// Turns `count` heights, `stride` apart, into controls: the first and the last are the heights there, in between
// c₋/8 + 3c/4 + c₊/8 = h. Elimination from the left, substitution from the right.
void FindControls(double* values, std::size_t count, std::size_t stride) {
  std::vector<double> share(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double pivot = 0.75 - share[i - 1] / 8;
    share[i] = 1 / (8 * pivot);
    values[i * stride] = (values[i * stride] - values[(i - 1) * stride] / 8) / pivot;
  }
  for (std::size_t i = count - 1; i-- > 1;) values[i * stride] -= share[i] * values[(i + 1) * stride];
}

// Adds a control at each end, on the line through the last two: the spline then ends at the height there.
void Extend(double* values, std::size_t count, std::size_t stride) {
  values[0] = 2 * values[stride] - values[2 * stride];
  values[(count + 1) * stride] = 2 * values[count * stride] - values[(count - 1) * stride];
}

// Bound of the slope: a slope is a mean of differences between neighbouring controls, so it is at most the largest
// difference that it reads.
double FindSteepest(const HeightField& field) {
  const auto width = static_cast<std::size_t>(field.columns) + 2;
  double steepest = 0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(field.rows); ++row) {
    for (std::size_t column = 0; column + 2 < width; ++column) {
      double x = 0, y = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 2; ++j) {
          const double* along = &field.controls[(row + i) * width + column + j];
          x = std::max(x, std::fabs(along[1] - along[0]));
          const double* across = &field.controls[(row + j) * width + column + i];
          y = std::max(y, std::fabs(across[width] - across[0]));
        }
      }
      steepest = std::max(steepest, FindHypotenuse(x, y) / field.cellSize);
    }
  }
  return steepest;
}

// The three basis functions at a point and their slopes, for t from −½ to ½ cells.
template <class Real>
struct Basis {
  std::array<Real, 3> weights;
  std::array<Real, 3> slopes;
};

template <class Real>
Basis<Real> FindBasis(Real t) {
  const Real before = Real(0.5) - t;
  const Real after = Real(0.5) + t;
  return {{before * before / Real(2), Real(0.75) - t * t, after * after / Real(2)}, {-before, Real(-2) * t, after}};
}

}  // namespace

std::shared_ptr<const HeightField> MakeHeightField(int columns, double cellSize, std::span<const double> heights) {
  const auto width = static_cast<std::size_t>(columns);
  const std::size_t depth = heights.size() / width;
  assert(columns >= 2 && columns <= kMaxFieldNodes && depth >= 2 && depth <= kMaxFieldNodes);
  assert(heights.size() == width * depth && cellSize > 0);
  HeightField field;
  field.columns = columns;
  field.rows = static_cast<int>(depth);
  field.cellSize = cellSize;
  const std::size_t stride = width + 2;
  field.controls.resize(stride * (depth + 2));
  for (std::size_t i = 0; i < heights.size(); ++i) {
    field.controls[(i / width + 1) * stride + i % width + 1] = heights[i];
  }
  double* controls = field.controls.data();
  for (std::size_t row = 1; row <= depth; ++row) FindControls(controls + row * stride + 1, width, 1);
  for (std::size_t column = 1; column <= width; ++column) FindControls(controls + stride + column, depth, stride);
  for (std::size_t row = 1; row <= depth; ++row) Extend(controls + row * stride, width, 1);
  for (std::size_t column = 0; column < stride; ++column) Extend(controls + column, depth, stride);
  field.steepest = FindSteepest(field);
  return std::make_shared<const HeightField>(std::move(field));
}

template <class Real>
FieldPoint<Real> FindFieldPoint(const HeightField& field, int column, int row, Real x, Real y, double base) {
  const auto stride = static_cast<std::size_t>(field.columns) + 2;
  const double* first = &field.controls[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)];
  const Basis<Real> across = FindBasis(x);
  const Basis<Real> along = FindBasis(y);
  FieldPoint<Real> point;
  for (std::size_t j = 0; j < 3; ++j) {
    std::array<Real, 3> h;
    for (std::size_t i = 0; i < 3; ++i) h[i] = static_cast<Real>(first[j * stride + i] - base);
    const Real height = across.weights[0] * h[0] + across.weights[1] * h[1] + across.weights[2] * h[2];
    const Real slope = across.slopes[0] * h[0] + across.slopes[1] * h[1] + across.slopes[2] * h[2];
    point.height += along.weights[j] * height;
    point.slopeX += along.weights[j] * slope;
    point.slopeY += along.slopes[j] * height;
  }
  const auto cell = static_cast<Real>(field.cellSize);
  point.slopeX /= cell;
  point.slopeY /= cell;
  return point;
}

double FindHeight(const HeightField& field, double x, double y) {
  const double u = std::clamp(x / field.cellSize, 0.0, field.columns - 1.0);
  const double v = std::clamp(y / field.cellSize, 0.0, field.rows - 1.0);
  const double column = std::nearbyint(u);
  const double row = std::nearbyint(v);
  return FindFieldPoint<double>(field, static_cast<int>(column), static_cast<int>(row), u - column, v - row, 0).height;
}

template FieldPoint<float> FindFieldPoint<float>(const HeightField&, int, int, float, float, double);
template FieldPoint<double> FindFieldPoint<double>(const HeightField&, int, int, double, double, double);

}  // namespace wobble::physics
