// How bodies are interpolated between samples.
#pragma once

#include <cstdint>

namespace wobble::client {

// kLinear is for comparisons.
enum class Curve : std::uint8_t { kCatmullRom, kLinear };

}  // namespace wobble::client
