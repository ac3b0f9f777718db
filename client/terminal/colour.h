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

// Of xterm's 256, the nearest but for the 16 that people redefine: 16..255.
[[nodiscard]] std::uint8_t FindNearest256(Colour colour);
// What xterm shows for it, 16..255.
[[nodiscard]] Colour Show256(std::uint8_t index);

// Of bodies: one's own, those of the scene, and of other players, each always the same, neighbours in number far apart
// and none like the own.
inline constexpr Light kOwnColour{1.0F, 0.36F, 0.04F};
inline constexpr Light kSceneColour{0.62F, 0.60F, 0.55F};
[[nodiscard]] Light FindPlayerColour(std::uint32_t body);

}  // namespace wobble::terminal
