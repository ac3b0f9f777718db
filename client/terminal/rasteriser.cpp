// A rasteriser with three edge functions and 1/depth, which is linear on the screen (Pineda 1988; Blinn 1992).
// Attributes are stored per sample and lit afterwards, so that only visible samples are lit, each with the interpolated
// normal: a ball of 162 vertices looks round.
#include "client/terminal/rasteriser.h"

#include <cmath>

#include "client/normals.h"
#include "client/terminal/fill.h"

namespace wobble::terminal {
namespace {

// A corner in the camera's frame: x right, y up, z depth.
struct CameraCorner {
  Vector3 at;
  Vector3 normal;
  Vector3 mark;
};

CameraCorner Interpolate(const CameraCorner& a, const CameraCorner& b, float share) {
  return {a.at + (b.at - a.at) * share, a.normal + (b.normal - a.normal) * share, a.mark + (b.mark - a.mark) * share};
}

// Sutherland and Hodgman's clipping by one plane: a triangle becomes none, a triangle or a quadrangle.
std::size_t ClipNear(const std::array<CameraCorner, 3>& corners, std::array<CameraCorner, 4>& kept) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const CameraCorner& from = corners[i];
    const CameraCorner& to = corners[(i + 1) % 3];
    const bool fromIn = from.at.z >= kNearPlane;
    if (fromIn) kept[count++] = from;
    if (fromIn != (to.at.z >= kNearPlane)) {
      kept[count++] = Interpolate(from, to, (kNearPlane - from.at.z) / (to.at.z - from.at.z));
      kept[count - 1].at.z = kNearPlane;
    }
  }
  return count;
}

bool IsFinite(Vector3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void FillTriangle(const std::array<const CameraCorner*, 3>& corners, float scale, std::uint32_t material,
                  SampleGrid& grid) {
  std::array<std::array<double, 2>, 3> at{};
  std::array<float, 3> inverse{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 p = corners[i]->at;
    inverse[i] = 1 / p.z;
    at[i] = {grid.width / 2.0 + static_cast<double>(p.x) * scale / p.z,
             grid.height / 2.0 - static_cast<double>(p.y) * scale / p.z};
  }
  ForEachPixel(at, grid.width, grid.height, [&](int x, int y, std::array<float, 3> share) {
    for (std::size_t i = 0; i < 3; ++i) share[i] *= inverse[i];
    const float inverseDepth = share[0] + share[1] + share[2];
    Sample& sample = grid.At(x, y);
    if (inverseDepth <= sample.inverseDepth) return;
    const float depth = 1 / inverseDepth;
    const auto mix = [&](Vector3 CameraCorner::*part) {
      return (corners[0]->*part * share[0] + corners[1]->*part * share[1] + corners[2]->*part * share[2]) * depth;
    };
    sample = {.inverseDepth = inverseDepth,
              .material = material,
              .normal = mix(&CameraCorner::normal),
              .mark = mix(&CameraCorner::mark)};
  });
}

}  // namespace

void SampleGrid::Reset(int newWidth, int newHeight) {
  width = newWidth;
  height = newHeight;
  samples.assign(static_cast<std::size_t>(width * height), Sample{});
}

void DrawTriangle(const View& view, const std::array<Corner, 3>& corners, std::uint32_t material, SampleGrid& grid) {
  std::array<CameraCorner, 3> seen;
  for (std::size_t i = 0; i < 3; ++i) {
    seen[i] = {view.ToCamera(corners[i].position), corners[i].normal, corners[i].mark};
    if (!IsFinite(seen[i].at)) return;
  }
  // The eye is at the origin of the camera's frame, which is left-handed: x right, y up, z forward.
  const Vector3 outward = Cross(seen[2].at - seen[0].at, seen[1].at - seen[0].at);
  if (!(Dot(outward, seen[0].at) < 0)) return;
  std::array<CameraCorner, 4> kept;
  const std::size_t count = ClipNear(seen, kept);
  const float scale = Viewport(grid.width, grid.height, view).scale;
  for (std::size_t i = 2; i < count; ++i) FillTriangle({&kept[0], &kept[i - 1], &kept[i]}, scale, material, grid);
}

void ComputeNormals(std::span<const Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                    std::vector<Vector3>& normals) {
  normals.resize(vertices.size());
  client::SumFaceNormals(vertices, faces, normals);
  for (Vector3& normal : normals) normal = Normalise(normal);
}

}  // namespace wobble::terminal
