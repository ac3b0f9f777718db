// Triangles to samples: a depth buffer that keeps, for each sample of the picture, what is nearest there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "client/terminal/view.h"

namespace wobble::terminal {

// Depth, metres, before which nothing is drawn.
inline constexpr float kNearPlane = 0.1F;

struct Corner {
  Vector3 position;  // in the world, metres
  Vector3 normal;
  Vector3 mark;  // whatever the surface's material makes of it
};

struct Sample {
  float inverseDepth = 0;  // 1/m; 0: nothing is there
  std::uint32_t material = 0;
  Vector3 normal;  // interpolated, not of unit length
  Vector3 mark;
};

struct SampleGrid {
  int width = 0;
  int height = 0;
  std::vector<Sample> samples;

  // Empties it.
  void Reset(int newWidth, int newHeight);
  [[nodiscard]] Sample& At(int x, int y) { return samples[static_cast<std::size_t>(y * width + x)]; }
  [[nodiscard]] const Sample& At(int x, int y) const { return samples[static_cast<std::size_t>(y * width + x)]; }
};

// Draws the front of a triangle (counterclockwise), cut off at the near plane. One of no area, or with a coordinate
// that is no number, draws nothing.
void DrawTriangle(const View& view, const std::array<Corner, 3>& corners, std::uint32_t material, SampleGrid& grid);

// Unit normals of a surface's vertices: the mean of the faces around each, by area. A vertex without any, or whose
// faces cancel out, gets (0, 0, 1). Faces name vertices that exist.
void ComputeNormals(std::span<const Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                    std::vector<Vector3>& normals);

}  // namespace wobble::terminal
