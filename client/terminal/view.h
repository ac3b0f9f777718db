// A pinhole camera at one moment.
#pragma once

#include "protocol/geometry.h"

namespace wobble::terminal {

using protocol::Vector3;

// Returns `otherwise` for a vector of zero length.
inline Vector3 Normalise(Vector3 v, Vector3 otherwise = {0, 0, 1}) {
  const float length = Length(v);
  return length > 1e-12F ? v * (1 / length) : otherwise;
}

// right, up, forward: orthonormal. The depth of a point is its distance along forward.
struct View {
  Vector3 eye;
  Vector3 right{1, 0, 0};
  Vector3 up{0, 0, 1};
  Vector3 forward{0, 1, 0};
  float tangent = 0.55F;  // of half the vertical field of view

  [[nodiscard]] Vector3 ToCamera(Vector3 point) const {
    const Vector3 from = point - eye;
    return {Dot(from, right), Dot(from, up), Dot(from, forward)};
  }
};

// Square pixels, origin in the upper left corner, y down.
struct Viewport {
  int width = 0;
  int height = 0;
  float scale = 0;  // pixels per metre at depth 1

  Viewport(int columns, int lines, const View& view)
      : width(columns), height(lines), scale(static_cast<float>(lines) / (2 * view.tangent)) {}

  // The point at depth 1 on the ray through a pixel's middle, relative to the eye.
  [[nodiscard]] Vector3 FindRay(const View& view, int x, int y) const {
    const float across = (static_cast<float>(x) + 0.5F - static_cast<float>(width) / 2) / scale;
    const float along = (static_cast<float>(height) / 2 - static_cast<float>(y) - 0.5F) / scale;
    return view.forward + view.right * across + view.up * along;
  }
};

}  // namespace wobble::terminal
