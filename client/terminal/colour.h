// The two kinds of colour: as the picture is reckoned, and as a terminal is told.
#pragma once

#include <cstdint>

#include "protocol/geometry.h"

namespace wobble::terminal {

// Linear light, red, green, blue; 1 is white, brighter is allowed.
using Light = protocol::Vector3;

// As shown, 0..255 with the display's gamma.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;

  bool operator==(const Colour&) const = default;
};

inline Light Blend(Light from, Light to, float share) { return from + (to - from) * share; }
inline Light Filter(Light light, Light by) { return {light.x * by.x, light.y * by.y, light.z * by.z}; }

// A gamma of 2 stands for the display's 2.2. Anything too bright is white, anything that is no number black.
[[nodiscard]] Colour Show(Light light);

}  // namespace wobble::terminal
