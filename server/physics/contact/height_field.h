// Ground given by heights over a grid: a smooth surface through or near them (height_field.cpp).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/physics/model/vector.h"

namespace wobble::physics {

inline constexpr int kMaxFieldNodes = 128;  // most heights along an axis; the least is 2

// z = h(x, y) over a rectangle; x and y count from its first corner, m. Made by MakeHeightField, immutable, shared by
// all obstacles that name it.
struct HeightField {
  int columns = 0;      // heights along x
  int rows = 0;         // and along y
  double cellSize = 1;  // from one to the next, m
  // Control points of the spline, row by row, with one more on every side: (columns + 2) × (rows + 2), m.
  std::vector<double> controls;
  double steepest = 0;  // bound of the slope: h nowhere rises by more than this in a metre
};

// heights: row by row, x first, m; their number is a multiple of `columns`. Columns and rows: 2 to kMaxFieldNodes.
// cellSize: m, above 0. Wrong values are asserted; the reader of scenes checks them.
[[nodiscard]] std::shared_ptr<const HeightField> MakeHeightField(int columns, double cellSize,
                                                                 std::span<const double> heights);

template <class Real>
struct FieldPoint {
  Real height = 0;  // m
  Real slopeX = 0;  // ∂h/∂x
  Real slopeY = 0;  // ∂h/∂y
};

// Height over `base` (m) and slopes at `x`, `y` cells from the node (column, row), each −½ to ½, or up to the field's
// end.
template <class Real>
[[nodiscard]] FieldPoint<Real> FindFieldPoint(const HeightField& field, int column, int row, Real x, Real y,
                                              double base);

// h(x, y), m; beyond the rectangle the height of its nearest point.
[[nodiscard]] double FindHeight(const HeightField& field, double x, double y);

}  // namespace wobble::physics
