// The receiver restores a number's high half from the newest that it has accepted: of the numbers with this low half it
// takes the nearest. A sender would have to be two billion datagrams ahead to be misread.
#include "protocol/transport/vestibule/seal.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>

namespace wobble::transport::vestibule {
namespace {

static_assert(kSealedTagBytes == crypto_aead_chacha20poly1305_ietf_ABYTES);
using Nonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

Nonce MakeNonce(std::uint64_t number) {
  Nonce nonce{};
  for (std::size_t i = 0; i < 8; ++i) nonce[4 + i] = static_cast<std::uint8_t>(number >> 8 * i);
  return nonce;
}

}  // namespace

void Sealer::Seal(SealedKind kind, std::uint32_t session, std::span<const std::span<const std::uint8_t>> plain,
                  std::vector<std::uint8_t>& out) {
  assert(session <= kMaxSessionNumber);
  const std::uint64_t number = ++m_newest;
  const std::size_t begin = out.size();
  out.push_back(static_cast<std::uint8_t>(kind));
  for (int i = 0; i < 3; ++i) out.push_back(static_cast<std::uint8_t>(session >> 8 * i));
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(number >> 8 * i));
  for (const std::span<const std::uint8_t> part : plain) out.insert(out.end(), part.begin(), part.end());
  const std::size_t bytes = out.size() - begin - kSealedHeadBytes;
  out.resize(out.size() + kSealedTagBytes);
  std::uint8_t* const head = out.data() + begin;
  std::uint8_t* const body = head + kSealedHeadBytes;
  crypto_aead_chacha20poly1305_ietf_encrypt(body, nullptr, body, bytes, head, kSealedHeadBytes, nullptr,
                                            MakeNonce(number).data(), m_key.data());
}

std::uint64_t Opener::FindNumber(std::uint32_t low) const {
  const auto ahead = static_cast<std::int32_t>(low - static_cast<std::uint32_t>(m_newest));
  // Below the first number there is none: a distance back beyond 0 means forward.
  const bool isBack = ahead < 0 && m_newest >= std::uint64_t{0} - static_cast<std::uint64_t>(std::int64_t{ahead});
  return isBack ? m_newest - static_cast<std::uint64_t>(-std::int64_t{ahead})
                : m_newest + static_cast<std::uint32_t>(ahead);
}

bool Opener::IsFresh(std::uint64_t number) const {
  if (number == 0) return false;
  if (number > m_newest) return true;
  return m_newest - number < kWindow && !m_seen[number % kWindow];
}

void Opener::Note(std::uint64_t number) {
  if (number > m_newest) {
    const std::uint64_t passed = std::min(number - m_newest, kWindow);
    for (std::uint64_t i = 1; i <= passed; ++i) m_seen[(m_newest + i) % kWindow] = false;
    // The numbers passed over by a leap beyond the window are older than it; their places are cleared too.
    if (passed == kWindow) m_seen.reset();
    m_newest = number;
  }
  m_seen[number % kWindow] = true;
}

bool Opener::Open(std::span<const std::uint8_t> datagram, std::vector<std::uint8_t>& plain) {
  if (datagram.size() < kSealedOverhead) return false;
  std::uint32_t low = 0;
  for (std::size_t i = 0; i < 4; ++i) low |= std::uint32_t{datagram[4 + i]} << 8 * i;
  const std::uint64_t number = FindNumber(low);
  if (!IsFresh(number)) return false;
  plain.resize(datagram.size() - kSealedOverhead);
  const int result = crypto_aead_chacha20poly1305_ietf_decrypt(
      plain.data(), nullptr, nullptr, datagram.data() + kSealedHeadBytes, datagram.size() - kSealedHeadBytes,
      datagram.data(), kSealedHeadBytes, MakeNonce(number).data(), m_key.data());
  if (result != 0) return false;
  Note(number);
  return true;
}

}  // namespace wobble::transport::vestibule
