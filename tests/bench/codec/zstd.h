// zstd at its highest compression level, without the frame fields that a packet already has: magic number, size,
// checksum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wobble::bench {

[[nodiscard]] std::vector<std::uint8_t> CompressWithZstd(std::span<const std::uint8_t> bytes);
// size: of the uncompressed data.
[[nodiscard]] std::vector<std::uint8_t> DecompressWithZstd(std::span<const std::uint8_t> bytes, std::size_t size);

}  // namespace wobble::bench
