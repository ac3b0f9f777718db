// A shadow map (Williams 1978) whose comparison is blurred over the four cells around a point (Reeves, Salesin and Cook
// 1987). Only bodies cast shadows and only surfaces receive them: a body's shadow on itself would need finer cells than
// it is worth.
#include "client/terminal/shadow.h"

#include <algorithm>
#include <cmath>

#include "client/terminal/fill.h"

namespace wobble::terminal {
namespace {

constexpr int kCells = 384;
constexpr float kNothing = -1e30F;
constexpr float kBias = 0.02F;  // metres; an occluder must be so much higher than the shaded point

// Basis of the plane perpendicular to the light: two unit vectors, normal to kToSun and to each other.
const Vector3 kAcross = Normalise(Cross({0, 1, 0}, kToSun));
const Vector3 kAlong = Cross(kToSun, kAcross);

}  // namespace

void ShadowMap::Reset(Vector3 middle, float halfWidth) {
  m_middle = middle;
  m_cellsPerMetre = kCells / (2 * halfWidth);
  m_heights.assign(static_cast<std::size_t>(kCells) * kCells, kNothing);
}

ShadowMap::Place ShadowMap::Find(Vector3 point) const {
  const Vector3 from = point - m_middle;
  return {Dot(from, kAcross) * m_cellsPerMetre + kCells / 2.0F, Dot(from, kAlong) * m_cellsPerMetre + kCells / 2.0F,
          Dot(from, kToSun)};
}

void ShadowMap::Add(std::span<const Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces) {
  for (const auto& face : faces) {
    std::array<std::array<double, 2>, 3> at{};
    std::array<float, 3> height{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Place place = Find(vertices[face[i]]);
      at[i] = {place.x, place.y};
      height[i] = place.towardsSun;
    }
    ForEachPixel(at, kCells, kCells, [&](int x, int y, const std::array<float, 3>& share) {
      float& highest = m_heights[static_cast<std::size_t>(y * kCells + x)];
      highest = std::max(highest, share[0] * height[0] + share[1] * height[1] + share[2] * height[2]);
    });
  }
}

float ShadowMap::FindShade(Vector3 point) const {
  const Place place = Find(point);
  const float left = std::floor(place.x - 0.5F), top = std::floor(place.y - 0.5F);
  if (!(left >= 0 && top >= 0 && left < kCells - 1 && top < kCells - 1)) return 0;
  const float right = place.x - 0.5F - left, bottom = place.y - 0.5F - top;
  const auto shade = [&](int x, int y) {
    const auto cell = static_cast<std::size_t>((static_cast<int>(top) + y) * kCells + static_cast<int>(left) + x);
    return m_heights[cell] > place.towardsSun + kBias ? 1.0F : 0.0F;
  };
  return (shade(0, 0) * (1 - right) + shade(1, 0) * right) * (1 - bottom) +
         (shade(0, 1) * (1 - right) + shade(1, 1) * right) * bottom;
}

}  // namespace wobble::terminal
