// Sealed datagrams: encrypted, authenticated, and each accepted once.
//
//   byte 0      kind (SealedKind)
//   bytes 1–3   session, little-endian; chosen by the server, 0 while the client does not know it
//   bytes 4–7   the low half of the datagram's number, little-endian; numbers count up from 1 and never repeat
//   then        the plain bytes under ChaCha20-Poly1305 (RFC 8439), and its tag of 16 bytes
//
// The nonce is four zero bytes and the number; the first eight bytes are authenticated with the rest. AES-GCM would
// save 0.3 points of a core with 64 clients, and needs a processor that has it; this does not.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/transport/vestibule/keys.h"

namespace wobble::transport::vestibule {

// data: a datagram of ENet. control: what the server's vestibule says (handshake.h).
enum class SealedKind : std::uint8_t { kData = 0x10, kControl = 0x11 };

inline constexpr std::size_t kSealedHeadBytes = 8;
inline constexpr std::size_t kSealedTagBytes = 16;
inline constexpr std::size_t kSealedOverhead = kSealedHeadBytes + kSealedTagBytes;

// Sessions have 24 bits.
inline constexpr std::uint32_t kMaxSessionNumber = 0xFFFFFF;
[[nodiscard]] inline std::uint32_t ReadSession(std::span<const std::uint8_t> datagram) {
  return datagram[1] | std::uint32_t{datagram[2]} << 8 | std::uint32_t{datagram[3]} << 16;
}

class Sealer {
 public:
  Sealer() = default;
  explicit Sealer(const Key& key) : m_key(key) {}

  // Appends the sealed datagram to `out`. plain: consecutive parts. session: at most kMaxSessionNumber.
  void Seal(SealedKind kind, std::uint32_t session, std::span<const std::span<const std::uint8_t>> plain,
            std::vector<std::uint8_t>& out);

 private:
  Key m_key{};
  std::uint64_t m_newest = 0;
};

class Opener {
 public:
  Opener() = default;
  explicit Opener(const Key& key) : m_key(key) {}

  // Opens a datagram into `plain` (replaced). False when it was not sealed with this key, was altered, has been
  // accepted before, or is more than kWindow behind the newest; nothing changes then.
  [[nodiscard]] bool Open(std::span<const std::uint8_t> datagram, std::vector<std::uint8_t>& plain);

  static constexpr std::uint64_t kWindow = 256;

 private:
  [[nodiscard]] std::uint64_t FindNumber(std::uint32_t low) const;
  [[nodiscard]] bool IsFresh(std::uint64_t number) const;
  void Note(std::uint64_t number);

  Key m_key{};
  std::uint64_t m_newest = 0;
  std::bitset<kWindow> m_seen;  // [number % kWindow], of the newest kWindow numbers
};

}  // namespace wobble::transport::vestibule
