#include "protocol/transport/vestibule/token.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>

namespace wobble::transport::vestibule {
namespace {

constexpr std::size_t kTokenNonceBytes = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES;
constexpr std::size_t kTokenTagBytes = crypto_aead_xchacha20poly1305_ietf_ABYTES;
constexpr std::size_t kTokenHeadBytes = 1 + kTokenNonceBytes;
constexpr std::size_t kTokenFixedBytes = 16 + 3 * 8 + 4 + 1 + 32 + 16 + 1;  // sealed, without the name

void AppendLittle(std::vector<std::uint8_t>& out, std::uint64_t number, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

std::uint64_t TakeLittle(std::span<const std::uint8_t>& bytes, std::size_t count) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < count; ++i) number |= std::uint64_t{bytes[i]} << 8 * i;
  bytes = bytes.subspan(count);
  return number;
}

template <std::size_t kSize>
void TakeArray(std::span<const std::uint8_t>& bytes, std::array<std::uint8_t, kSize>& out) {
  std::copy_n(bytes.begin(), kSize, out.begin());
  bytes = bytes.subspan(kSize);
}

std::vector<std::uint8_t> WriteTokenPlain(const Token& token) {
  std::vector<std::uint8_t> plain(token.number.begin(), token.number.end());
  AppendLittle(plain, token.issued, 8);
  AppendLittle(plain, token.expires, 8);
  AppendLittle(plain, token.admission.account, 8);
  AppendLittle(plain, token.admission.invite, 4);
  plain.push_back(static_cast<std::uint8_t>(token.admission.rank));
  plain.insert(plain.end(), token.server.begin(), token.server.end());
  plain.insert(plain.end(), token.admission.from.ip.begin(), token.admission.from.ip.end());
  const auto& name = token.admission.name;
  const auto end = std::find(name.begin(), name.end(), '\0');
  plain.push_back(static_cast<std::uint8_t>(end - name.begin()));
  plain.insert(plain.end(), name.begin(), end);
  return plain;
}

std::optional<Token> ReadTokenPlain(std::span<const std::uint8_t> plain) {
  if (plain.size() < kTokenFixedBytes) return {};
  Token token;
  TakeArray(plain, token.number);
  token.issued = TakeLittle(plain, 8);
  token.expires = TakeLittle(plain, 8);
  token.admission.account = TakeLittle(plain, 8);
  token.admission.invite = static_cast<std::uint32_t>(TakeLittle(plain, 4));
  const std::uint64_t rank = TakeLittle(plain, 1);
  TakeArray(plain, token.server);
  TakeArray(plain, token.admission.from.ip);
  const std::uint64_t bytes = TakeLittle(plain, 1);
  if (rank > static_cast<std::uint64_t>(Rank::kOwner) || bytes > token.admission.name.size() || bytes != plain.size())
    return {};
  token.admission.rank = static_cast<Rank>(rank);
  std::copy(plain.begin(), plain.end(), token.admission.name.begin());
  return token;
}

}  // namespace

std::vector<std::uint8_t> SealToken(TokenKind kind, const Token& token, const Key& key, const RandomSource& random) {
  const std::vector<std::uint8_t> plain = WriteTokenPlain(token);
  std::vector<std::uint8_t> out(kTokenHeadBytes + plain.size() + kTokenTagBytes);
  out[0] = static_cast<std::uint8_t>(kind);
  random({out.data() + 1, kTokenNonceBytes});
  crypto_aead_xchacha20poly1305_ietf_encrypt(out.data() + kTokenHeadBytes, nullptr, plain.data(), plain.size(),
                                             out.data(), 1, nullptr, out.data() + 1, key.data());
  return out;
}

std::optional<Token> OpenToken(TokenKind kind, std::span<const std::uint8_t> bytes, const Key& key) {
  if (bytes.size() < kTokenHeadBytes + kTokenFixedBytes + kTokenTagBytes ||
      bytes[0] != static_cast<std::uint8_t>(kind)) {
    return {};
  }
  std::vector<std::uint8_t> plain(bytes.size() - kTokenHeadBytes - kTokenTagBytes);
  const int result = crypto_aead_xchacha20poly1305_ietf_decrypt(
      plain.data(), nullptr, nullptr, bytes.data() + kTokenHeadBytes, bytes.size() - kTokenHeadBytes, bytes.data(), 1,
      bytes.data() + 1, key.data());
  return result == 0 ? ReadTokenPlain(plain) : std::nullopt;
}

std::size_t CountIntroductionBytes() { return kTokenHeadBytes + kTokenFixedBytes + kTokenTagBytes; }

std::string FormatSecret(std::span<const std::uint8_t> bytes) {
  constexpr int kVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
  std::string text(sodium_base64_encoded_len(bytes.size(), kVariant), '\0');
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), kVariant);
  text.pop_back();
  return text;
}

std::optional<std::vector<std::uint8_t>> ParseSecret(std::string_view text) {
  if (text.empty()) return {};
  std::vector<std::uint8_t> bytes(text.size());
  std::size_t size = 0;
  const char* end = nullptr;
  const int result = sodium_base642bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &size, &end,
                                       sodium_base64_VARIANT_URLSAFE_NO_PADDING);
  if (result != 0 || end != text.data() + text.size() || size == 0) return {};
  bytes.resize(size);
  // libsodium reads the byte 0xff as if it were '_': one secret would have two texts.
  if (FormatSecret(bytes) != text) return {};
  return bytes;
}

}  // namespace wobble::transport::vestibule
