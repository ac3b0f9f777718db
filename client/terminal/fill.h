// The loop over a triangle's pixels, a template so that the action on each pixel is inlined.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace wobble::terminal {

// Calls `fill(x, y, share)` for every pixel of 0..width x 0..height whose middle lies in the triangle; share holds the
// barycentric weights of the corners there, with a sum of one. Both windings are filled; pixels on an edge belong to
// both triangles. Corners are in pixels, as double: a corner close to the near plane lies far outside of the picture.

template <typename Fill>
void ForEachPixel(const std::array<std::array<double, 2>, 3>& at, int width, int height, const Fill& fill) {
  const double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
  if (!std::isfinite(area) || area == 0) return;
  std::array<std::array<double, 2>, 2> range{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto [least, most] = std::minmax({at[0][axis], at[1][axis], at[2][axis]});
    const double limit = axis == 0 ? width : height;
    range[axis] = {std::clamp(std::ceil(least - 0.5), 0.0, limit), std::clamp(std::floor(most - 0.5) + 1, 0.0, limit)};
  }
  // weight of corner i = start + x * stepX + y * stepY
  std::array<std::array<double, 3>, 3> edge{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& a = at[(i + 1) % 3];
    const auto& b = at[(i + 2) % 3];
    const double stepX = (a[1] - b[1]) / area, stepY = (b[0] - a[0]) / area;
    edge[i] = {-a[0] * stepX - a[1] * stepY, stepX, stepY};
  }
  for (int y = static_cast<int>(range[1][0]); y < static_cast<int>(range[1][1]); ++y) {
    std::array<double, 3> row{};
    for (std::size_t i = 0; i < 3; ++i) row[i] = edge[i][0] + (y + 0.5) * edge[i][2];
    for (int x = static_cast<int>(range[0][0]); x < static_cast<int>(range[0][1]); ++x) {
      const double middle = x + 0.5;
      const std::array<float, 3> share{static_cast<float>(row[0] + middle * edge[0][1]),
                                       static_cast<float>(row[1] + middle * edge[1][1]),
                                       static_cast<float>(row[2] + middle * edge[2][1])};
      if (share[0] >= 0 && share[1] >= 0 && share[2] >= 0) fill(x, y, share);
    }
  }
}

}  // namespace wobble::terminal
