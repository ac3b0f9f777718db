// Ground as heights over a grid: a smooth surface through them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/physics/model/vector.h"

namespace wobble::physics {

inline constexpr int kMaxFieldNodes = 128;  // heights along an axis; at least 2

// z = h(x, y) over a rectangle; x and y from its first corner, m. Made by MakeHeightField, immutable, shared by all who
// name it.
struct HeightField {
  int columns = 0;      // heights along x
  int rows = 0;         // and along y
  double cellSize = 1;  // from one to the next, m
  // Of the spline, row by row, with one more on every side: (columns + 2) × (rows + 2), m.
  std::vector<double> controls;
  double steepest = 0;  // h nowhere rises by more than this in a metre
};

// heights: row by row, x first, m; a multiple of `columns`, both within the limits above.
[[nodiscard]] std::shared_ptr<const HeightField> MakeHeightField(int columns, double cellSize,
                                                                 std::span<const double> heights);

template <class Real>
struct FieldPoint {
  Real height = 0;  // m
  Real slopeX = 0;  // ∂h/∂x
  Real slopeY = 0;  // ∂h/∂y
};

// At `x`, `y` cells from the node (column, row), each −½ to ½, or less far where the field ends; heights are counted
// from `base`, m.
template <class Real>
[[nodiscard]] FieldPoint<Real> FindFieldPoint(const HeightField& field, int column, int row, Real x, Real y,
                                              double base);

// h(x, y), m; beyond the rectangle that of its nearest point.
[[nodiscard]] double FindHeight(const HeightField& field, double x, double y);

}  // namespace wobble::physics
