// How bodies are shown between the moments that are known of them.
#pragma once

#include <cstdint>

namespace wobble::client {

// kLinear is there to be compared with.
enum class Curve : std::uint8_t { kCatmullRom, kLinear };

}  // namespace wobble::client
