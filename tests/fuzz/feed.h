// Takes a fuzzer's bytes apart; after their end there are zeros.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace wobble::fuzz {

class Feed {
 public:
  explicit Feed(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {}

  [[nodiscard]] bool IsEmpty() const { return m_bytes.empty(); }
  std::uint8_t TakeByte() { return Take<std::uint8_t>(); }
  template <class Number>
  Number Take() {
    Number number{};
    const std::size_t size = std::min(sizeof number, m_bytes.size());
    if (size > 0) std::memcpy(&number, m_bytes.data(), size);
    m_bytes = m_bytes.subspan(size);
    return number;
  }
  // As many as a byte in front of them says, or fewer at the end.
  std::vector<std::uint8_t> TakeSome() {
    const std::size_t asked = TakeByte();
    const std::size_t size = std::min(asked, m_bytes.size());
    std::vector<std::uint8_t> some(m_bytes.begin(), m_bytes.begin() + static_cast<std::ptrdiff_t>(size));
    m_bytes = m_bytes.subspan(size);
    return some;
  }
  std::string TakeText() {
    const std::vector<std::uint8_t> some = TakeSome();
    return {some.begin(), some.end()};
  }
  [[nodiscard]] std::span<const std::uint8_t> Rest() const { return m_bytes; }

 private:
  std::span<const std::uint8_t> m_bytes;
};

}  // namespace wobble::fuzz
