// Bits into bytes and back, least significant bit first.
//
// The reader takes untrusted bytes: past the end it returns zeros and remembers it, so a decoder needs one check at its
// end instead of one per field.
#pragma once

#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::protocol {

class BitWriter {
 public:
  // Appends to `bytes`, which must outlive the writer.
  explicit BitWriter(std::vector<std::uint8_t>& bytes) : m_bytes(bytes) {}

  // value < 2^count, 0 <= count <= 32.
  void Write(std::uint32_t value, unsigned count) {
    assert(count <= 32 && (count == 32 || value >> count == 0));
    m_pending |= static_cast<std::uint64_t>(value) << m_pendingCount;
    m_pendingCount += count;
    while (m_pendingCount >= 8) {
      m_bytes.push_back(static_cast<std::uint8_t>(m_pending));
      m_pending >>= 8;
      m_pendingCount -= 8;
    }
  }

  // Seven bits a byte, the lowest first; the eighth bit says that another byte follows.
  void WriteVarint(std::uint32_t value) {
    while (value >= 0x80) {
      Write((value & 0x7F) | 0x80, 8);
      value >>= 7;
    }
    Write(value, 8);
  }

  // Fills the last byte with zero bits. To be called once, at the end of a record.
  void Align() {
    if (m_pendingCount > 0) Write(0, 8 - m_pendingCount);
  }

 private:
  std::vector<std::uint8_t>& m_bytes;
  std::uint64_t m_pending = 0;
  unsigned m_pendingCount = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {}

  // 0 <= count <= 32. Returns 0, and Overran() is true from then on, when fewer bits are left.
  std::uint32_t Read(unsigned count) {
    assert(count <= 32);
    while (m_pendingCount < count) {
      if (m_next == m_bytes.size()) {
        m_overran = true;
        m_pending = 0;
        m_pendingCount = 0;
        return 0;
      }
      m_pending |= static_cast<std::uint64_t>(m_bytes[m_next++]) << m_pendingCount;
      m_pendingCount += 8;
    }
    const auto value = static_cast<std::uint32_t>(m_pending & ((std::uint64_t{1} << count) - 1));
    m_pending >>= count;
    m_pendingCount -= count;
    return value;
  }

  // Returns 0, and Overran() is true, when the bytes are no 32-bit number in its shortest form.
  std::uint32_t ReadVarint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const std::uint32_t byte = Read(8);
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if ((byte & 0x80) == 0) {
        if ((shift > 0 && byte == 0) || value > 0xFFFFFFFF) break;
        return m_overran ? 0 : static_cast<std::uint32_t>(value);
      }
    }
    m_overran = true;
    return 0;
  }

  [[nodiscard]] bool Overran() const { return m_overran; }
  // Whether nothing is left but the zero bits that fill the last byte.
  [[nodiscard]] bool AtEnd() const { return m_next == m_bytes.size() && m_pendingCount < 8 && m_pending == 0; }
  // The first byte that has not been begun; only meaningful when whole bytes have been read.
  [[nodiscard]] std::size_t ByteOffset() const { return m_next; }

 private:
  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
  std::uint64_t m_pending = 0;
  unsigned m_pendingCount = 0;
  bool m_overran = false;
};

}  // namespace wobble::protocol
