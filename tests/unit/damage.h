// Every truncation and every change of one byte of a message, for tests of code that reads bytes from the wire.
//
// The damaged bytes lie in a block of exactly their size, so that under AddressSanitizer a read past the end is seen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wobble::test {

using Bytes = std::vector<std::uint8_t>;

// use(bytes) for every length shorter than the whole.
template <class Use>
void ForEachTruncation(std::span<const std::uint8_t> whole, Use use) {
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    use(std::span<const std::uint8_t>(cut));
  }
}

// use(bytes) with every byte replaced by every other value, which includes every flip of bits within a byte.
template <class Use>
void ForEachChangedByte(std::span<const std::uint8_t> whole, Use use) {
  Bytes changed(whole.begin(), whole.end());
  for (std::size_t at = 0; at < changed.size(); ++at) {
    for (unsigned difference = 1; difference < 256; ++difference) {
      changed[at] = static_cast<std::uint8_t>(whole[at] ^ difference);
      use(std::span<const std::uint8_t>(changed));
    }
    changed[at] = whole[at];
  }
}

}  // namespace wobble::test
