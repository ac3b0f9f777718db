// The two representations of colour: linear light, in which the picture is computed, and the values sent to a terminal.
#pragma once

#include <cstdint>

#include "protocol/geometry.h"

namespace wobble::terminal {

// Linear light: red, green, blue; 1 is white, brighter values are allowed.
using Light = protocol::Vector3;

// A displayed colour, 0..255 per channel, with the display's gamma.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;

  bool operator==(const Colour&) const = default;
};

inline Light Blend(Light from, Light to, float share) { return from + (to - from) * share; }
inline Light Filter(Light light, Light by) { return {light.x * by.x, light.y * by.y, light.z * by.z}; }

// Converts to a displayed colour, with a gamma of 2 in place of the display's 2.2. Values above 1 become white, NaN
// black.
[[nodiscard]] Colour Show(Light light);

// Index of the nearest of xterm's 256 colours, 16..255; the first 16 are left out because users redefine them.
[[nodiscard]] std::uint8_t FindNearest256(Colour colour);
// The colour that xterm shows for an index of 16..255.
[[nodiscard]] Colour Show256(std::uint8_t index);

// Colours of the player's own body, of the scene's bodies and of other players. A body number always gives the same
// colour; neighbouring numbers give colours far apart, and none resembles the player's own.
inline constexpr Light kOwnColour{1.0F, 0.36F, 0.04F};
inline constexpr Light kSideColours[] = {{0.05F, 0.22F, 0.9F}, {0.87F, 0.08F, 0.13F}};  // of sides 1 and 2 of a game
inline constexpr Light kSceneColour{0.62F, 0.60F, 0.55F};
[[nodiscard]] Light FindPlayerColour(std::uint32_t body);

}  // namespace wobble::terminal
