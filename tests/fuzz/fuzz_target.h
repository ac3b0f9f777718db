// What a fuzz target is: one function that takes any bytes and must come back. libFuzzer calls it with bytes that it
// makes up, replay.cpp with those of the corpus; both through LLVMFuzzerTestOneInput, which each target defines.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace wobble::fuzz {

// Ends the program at once, so that libFuzzer keeps the input; an assertion would be gone from a release build.
inline void Require(bool condition) {
  if (!condition) __builtin_trap();
}

}  // namespace wobble::fuzz
