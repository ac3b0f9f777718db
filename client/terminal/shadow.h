// Shadows of bodies: how high above a plane across the light something stands, on a grid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/terminal/view.h"

namespace wobble::terminal {

// Towards the sun, unit length. Steep: a shadow lies nearly below its body and tells its height.
inline constexpr Vector3 kToSun{-0.3144F, -0.2096F, 0.9258F};

class ShadowMap {
 public:
  // A square of `halfWidth` metres to each side of `middle`; empties it.
  void Reset(Vector3 middle, float halfWidth);
  void Add(std::span<const Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces);
  // 0 in the light to 1 in the shadow of something; 0 outside of the square. Blurred over a few centimetres.
  [[nodiscard]] float FindShade(Vector3 point) const;

 private:
  struct Place {
    float x = 0, y = 0;    // in cells
    float towardsSun = 0;  // metres
  };
  [[nodiscard]] Place Find(Vector3 point) const;

  Vector3 m_middle;
  float m_cellsPerMetre = 0;
  std::vector<float> m_heights;  // towards the sun, of the highest there
};

}  // namespace wobble::terminal
