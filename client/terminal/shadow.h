// Shadows of bodies: a grid of heights above a plane perpendicular to the light.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/terminal/view.h"

namespace wobble::terminal {

// Unit vector towards the sun. Steep: a shadow lies nearly below its body and shows its height.
inline constexpr Vector3 kToSun{-0.3144F, -0.2096F, 0.9258F};

class ShadowMap {
 public:
  // Empties the map and sets it to a square that extends `halfWidth` metres to each side of `middle`.
  void Reset(Vector3 middle, float halfWidth);
  void Add(std::span<const Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces);
  // 0 in the light to 1 in shadow; 0 outside of the square. Blurred over a few centimetres.
  [[nodiscard]] float FindShade(Vector3 point) const;

 private:
  struct Place {
    float x = 0, y = 0;    // in cells
    float towardsSun = 0;  // metres
  };
  [[nodiscard]] Place Find(Vector3 point) const;

  Vector3 m_middle;
  float m_cellsPerMetre = 0;
  std::vector<float> m_heights;  // greatest towardsSun in each cell, metres
};

}  // namespace wobble::terminal
