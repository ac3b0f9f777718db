// A static range coder: turns symbols of known frequency into bytes and back, in integers.
//
// Carries propagate into the bytes already written (as in Martin 1979) instead of being avoided by a narrower range,
// which saves 0.1 bit a record over the carry-less variant. The encoder ends with the shortest bytes that, with zeros
// behind them, lie in the last range: half a byte more than the symbols are worth. rANS was as dense, but writes from
// the back, which the encoder's adaptive contexts do not allow.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wobble::protocol {

// Frequencies of a table add up to 2^kFrequencyBits.
inline constexpr unsigned kFrequencyBits = 12;
inline constexpr std::uint32_t kFrequencyTotal = 1U << kFrequencyBits;

// A range encoder whose bytes have room enough: for loops that keep it in registers. It runs 700 times for a ball of
// 162 vertices.
class RangeWriter {
 public:
  // at: where bytes go, behind those already written.
  explicit RangeWriter(std::uint8_t* at) : m_at(at) {}

  // As of RangeEncoder. Each writes at most three bytes.
  void Encode(std::uint32_t start, std::uint32_t frequency) {
    m_range >>= kFrequencyBits;
    Narrow(start, frequency);
  }
  void EncodeUniform(std::uint32_t value, std::uint32_t count) {
    m_range /= count;
    Narrow(value, 1);
  }
  void EncodeBits(std::uint32_t value, unsigned bits) {
    m_range >>= bits;
    Narrow(value, 1);
  }
  [[nodiscard]] std::uint8_t* At() const { return m_at; }
  // The bytes have moved.
  void MoveTo(std::uint8_t* at) { m_at = at; }
  // Writes at most four bytes.
  void Finish();

 private:
  void Narrow(std::uint32_t start, std::uint32_t width) {
    const std::uint32_t before = m_low;
    m_low += start * m_range;
    if (m_low < before) AddCarry(m_at);
    m_range *= width;
    while (m_range < 1U << 24) {
      *m_at++ = static_cast<std::uint8_t>(m_low >> 24);
      m_low <<= 8;
      m_range <<= 8;
    }
  }
  // The range never leaves that of the bytes written so far, so one of them always takes the carry.
  static void AddCarry(std::uint8_t* at) {
    while (++*--at == 0) {
    }
  }

  std::uint8_t* m_at;
  std::uint32_t m_low = 0;
  std::uint32_t m_range = 0xFFFFFFFF;
};

class RangeEncoder {
 public:
  // Appends to `bytes`, which must outlive the encoder and have no other use until Finish.
  explicit RangeEncoder(std::vector<std::uint8_t>& bytes) : m_bytes(bytes), m_begin(bytes.size()), m_writer(nullptr) {
    m_bytes.resize(m_begin + kRoom);
    m_writer.MoveTo(m_bytes.data() + m_begin);
  }

  // A symbol with the share [start, start + frequency) of kFrequencyTotal; frequency > 0.
  void Encode(std::uint32_t start, std::uint32_t frequency) { Writer().Encode(start, frequency); }
  // value < count, all equally likely; 1 <= count <= 2^17.
  void EncodeUniform(std::uint32_t value, std::uint32_t count) { Writer().EncodeUniform(value, count); }
  // value < 2^bits, bits <= 16.
  void EncodeBits(std::uint32_t value, unsigned bits) { Writer().EncodeBits(value, bits); }
  // To be called once, at the end. At least one byte has then been written.
  void Finish();

  // For a loop of its own: a writer that has room for kWriterRoom bytes, and at the end, or when these may not suffice,
  // its return.
  static constexpr std::size_t kWriterRoom = 64;
  [[nodiscard]] RangeWriter TakeWriter() { return Writer(); }
  void Return(const RangeWriter& writer) { m_writer = writer; }
  [[nodiscard]] std::size_t FindRoom(const RangeWriter& writer) const {
    return static_cast<std::size_t>(m_bytes.data() + m_bytes.size() - writer.At());
  }

 private:
  static constexpr std::size_t kRoom = 512;
  RangeWriter& Writer() {
    if (FindRoom(m_writer) < kWriterRoom) MakeRoom();
    return m_writer;
  }
  void MakeRoom();

  std::vector<std::uint8_t>& m_bytes;  // with room behind those written
  std::size_t m_begin;
  RangeWriter m_writer;
};

// Takes untrusted bytes: every call returns a value within its bounds, also past the end.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {
    for (int i = 0; i < 4; ++i) m_code = m_code << 8 | NextByte();
  }

  // A place in [0, kFrequencyTotal) inside the next symbol's share. Take must follow, with that symbol's share.
  std::uint32_t Find() {
    m_range >>= kFrequencyBits;
    const std::uint32_t place = m_code / m_range;
    return place < kFrequencyTotal ? place : kFrequencyTotal - 1;
  }
  // Without the division of Find: Begin, then Reaches for the starts of symbols in ascending order, until one is not
  // reached; then Take. A symbol's start is reached where Find gives it or more.
  void Begin() { m_range >>= kFrequencyBits; }
  [[nodiscard]] bool Reaches(std::uint32_t start) const { return start * m_range <= m_code; }
  void Take(std::uint32_t start, std::uint32_t frequency) {
    m_code -= start * m_range;
    m_range *= frequency;
    Refill();
  }
  std::uint32_t DecodeUniform(std::uint32_t count) {
    m_range /= count;
    std::uint32_t value = m_code / m_range;
    if (value >= count) value = count - 1;
    m_code -= value * m_range;
    Refill();
    return value;
  }
  std::uint32_t DecodeBits(unsigned bits) {
    m_range >>= bits;
    std::uint32_t value = m_code / m_range;
    if (value >> bits != 0) value = (1U << bits) - 1;
    m_code -= value * m_range;
    Refill();
    return value;
  }
  // DecodeBits(1) without its division.
  std::uint32_t DecodeBit() {
    m_range >>= 1;
    const bool isOne = m_code >= m_range;
    m_code -= isOne ? m_range : 0;
    Refill();
    return isOne ? 1 : 0;
  }
  // For refusing bytes that no encoder wrote: an honest stream is never read further than four bytes past its end, and
  // no whole byte of it is left unread.
  [[nodiscard]] bool Overran() const { return m_next > m_bytes.size() + 4; }
  [[nodiscard]] bool LeftBytes() const { return m_next < m_bytes.size(); }

 private:
  std::uint32_t NextByte() {
    const std::size_t at = m_next++;
    return at < m_bytes.size() ? m_bytes[at] : 0;
  }
  void Refill() {
    while (m_range < 1U << 24) {
      m_code = m_code << 8 | NextByte();
      m_range <<= 8;
    }
  }

  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
  std::uint32_t m_code = 0;
  std::uint32_t m_range = 0xFFFFFFFF;
};

}  // namespace wobble::protocol
