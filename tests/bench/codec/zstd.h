// zstd at its most thorough, without the parts of a frame that a packet says already: magic number, size, checksum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wobble::bench {

[[nodiscard]] std::vector<std::uint8_t> CompressWithZstd(std::span<const std::uint8_t> bytes);
// size: of what was compressed.
[[nodiscard]] std::vector<std::uint8_t> DecompressWithZstd(std::span<const std::uint8_t> bytes, std::size_t size);

}  // namespace wobble::bench
