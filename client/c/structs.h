// How structs pass between programs and a library of different ages: both sides touch only what both know.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "client/wobble.h"

namespace wobble::c {

// What a struct had in the first release that had it; no program knows less. A struct that grows gets a specialisation
// with its old size.
template <typename Struct>
inline constexpr std::size_t kFirstSize = sizeof(Struct);

template <typename Struct>
[[nodiscard]] wobble_result CheckStruct(const Struct* given) {
  if (given == nullptr) return WOBBLE_NULL;
  return given->struct_size < kFirstSize<Struct> ? WOBBLE_BAD_SIZE : WOBBLE_OK;
}

// Reads a struct that has been checked. What the caller does not know is zero.
template <typename Struct>
[[nodiscard]] Struct Read(const Struct& given) {
  Struct known{};
  std::memcpy(&known, &given, std::min<std::size_t>(given.struct_size, sizeof known));
  return known;
}

// Writes a struct that has been checked, as far as the caller knows it.
template <typename Struct>
void Write(Struct known, Struct& given) {
  known.struct_size = given.struct_size;
  std::memcpy(&given, &known, std::min<std::size_t>(given.struct_size, sizeof known));
}

}  // namespace wobble::c
