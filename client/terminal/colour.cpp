// Converts linear light to the colours of terminals. The first 16 of the 256 colours are not used: users redefine them.
#include "client/terminal/colour.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace wobble::terminal {
namespace {

// Levels of xterm's colour cube; its greys are 8, 18 ... 238.
constexpr int kLevels[] = {0, 95, 135, 175, 215, 255};

int FindLevel(int value) {
  int best = 0;
  for (int i = 1; i < 6; ++i) {
    if (std::abs(kLevels[i] - value) < std::abs(kLevels[best] - value)) best = i;
  }
  return best;
}

int Distance(Colour a, Colour b) {
  const auto square = [](int x) { return x * x; };
  return square(a.red - b.red) + square(a.green - b.green) + square(a.blue - b.blue);
}

}  // namespace

Colour Show(Light light) {
  const auto show = [](float value) {
    if (!(value > 0)) return std::uint8_t{0};
    return static_cast<std::uint8_t>(std::lround(std::sqrt(std::min(value, 1.0F)) * 255));
  };
  return {show(light.x), show(light.y), show(light.z)};
}

std::uint8_t FindNearest256(Colour colour) {
  const int red = FindLevel(colour.red), green = FindLevel(colour.green), blue = FindLevel(colour.blue);
  const auto cube = static_cast<std::uint8_t>(16 + 36 * red + 6 * green + blue);
  const int mean = (colour.red + colour.green + colour.blue) / 3;
  const auto grey = static_cast<std::uint8_t>(232 + std::clamp((mean - 3) / 10, 0, 23));
  return Distance(Show256(grey), colour) < Distance(Show256(cube), colour) ? grey : cube;
}

Colour Show256(std::uint8_t index) {
  assert(index >= 16);
  if (index >= 232) {
    const auto grey = static_cast<std::uint8_t>(8 + 10 * (index - 232));
    return {grey, grey, grey};
  }
  const int cube = std::max(index - 16, 0);  // never below; gcc for ARM does not know
  const auto level = [](int i) { return static_cast<std::uint8_t>(kLevels[i]); };
  return {level(cube / 36), level(cube / 6 % 6), level(cube % 6)};
}

// Hues in steps of the golden ratio lie apart for any set of numbers.
Light FindPlayerColour(std::uint32_t body) {
  const double turn = std::fmod(body * 0.61803398875, 1.0);
  const auto hue = static_cast<float>(0.22 + 0.70 * turn) * 6;  // in sixths of the circle; red to orange is left out
  const auto channel = [hue](float at) {
    const float away = std::abs(hue - at);
    const float level = std::clamp(2 - std::min(away, 6 - away), 0.0F, 1.0F);
    return 0.06F + 0.80F * level * level;
  };
  return {channel(0), channel(2), channel(4)};
}

}  // namespace wobble::terminal
