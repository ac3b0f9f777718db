// Turns triangles into samples: a depth buffer that keeps the nearest surface of each sample of the picture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "client/terminal/view.h"

namespace wobble::terminal {

// Depth (metres) in front of which nothing is drawn.
inline constexpr float kNearPlane = 0.1F;

struct Corner {
  Vector3 position;  // in the world, metres
  Vector3 normal;
  Vector3 mark;  // attribute interpreted by the surface's material
};

struct Sample {
  float inverseDepth = 0;  // 1/m; 0: nothing drawn here
  std::uint32_t material = 0;
  Vector3 normal;  // interpolated, not of unit length
  Vector3 mark;
};

struct SampleGrid {
  int width = 0;
  int height = 0;
  std::vector<Sample> samples;

  // Sets the size and empties all samples.
  void Reset(int newWidth, int newHeight);
  [[nodiscard]] Sample& At(int x, int y) { return samples[static_cast<std::size_t>(y * width + x)]; }
  [[nodiscard]] const Sample& At(int x, int y) const { return samples[static_cast<std::size_t>(y * width + x)]; }
};

// Draws the front (counterclockwise) of a triangle, clipped at the near plane. A triangle with no area or with a
// coordinate that is not finite draws nothing.
void DrawTriangle(const View& view, const std::array<Corner, 3>& corners, std::uint32_t material, SampleGrid& grid);

// Computes unit normals of a surface's vertices: the mean of the adjacent faces, weighted by area. A vertex without
// faces, or whose faces cancel out, gets (0, 0, 1). Faces must name existing vertices.
void ComputeNormals(std::span<const Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                    std::vector<Vector3>& normals);

}  // namespace wobble::terminal
