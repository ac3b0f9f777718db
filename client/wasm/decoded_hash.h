// A hash over everything a client has decoded: two clients that got the same messages have the same hash.
#pragma once

#include <cstddef>
#include <cstdint>

#include "client/client.h"

namespace wobble::wasm {

// FNV-1a, 64 bits, over each record's body, tick, pose and vertices as they are in memory. All machines are
// little-endian.
class DecodedHash {
 public:
  void Add(const client::DecodedPatch& patch) {
    AddBytes(&patch.body, sizeof patch.body);
    AddBytes(&patch.tick, sizeof patch.tick);
    AddBytes(&patch.pose, sizeof patch.pose);
    AddBytes(patch.shape.data(), patch.shape.size_bytes());
  }
  [[nodiscard]] std::uint64_t Value() const { return m_value; }

 private:
  void AddBytes(const void* bytes, std::size_t size) {
    const auto* next = static_cast<const std::uint8_t*>(bytes);
    for (std::size_t i = 0; i < size; ++i) m_value = (m_value ^ next[i]) * 0x100000001B3U;
  }

  std::uint64_t m_value = 0xCBF29CE484222325U;
};

}  // namespace wobble::wasm
