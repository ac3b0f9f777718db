// Tokens: what somebody whom the server trusts says of a client, sealed with a key that only these two have.
//
//   byte 0        TokenKind
//   1..24         nonce, random
//   25..          sealed (XChaCha20-Poly1305, byte 0 authenticated with it): number 16 B, issued u64, expires u64,
//                 account u64, invite u32, rank u8, the server's key 32 B, address 16 B, length of the name u8, name
//
// Numbers are little-endian. The idea is netcode's connect token; session keys are not in it, because the handshake
// makes them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/transport/admission.h"
#include "protocol/transport/vestibule/keys.h"

namespace wobble::transport::vestibule {

// kConnect: of a matchmaker, for one connection. kTicket: of the server itself, for a client that it has let in and
// that may come back. kIntroduction: of a gateway, says a browser's address.
enum class TokenKind : std::uint8_t { kConnect = 1, kTicket = 2, kIntroduction = 3 };

struct Token {
  std::array<std::uint8_t, 16> number{};  // random; a connect token's is good once
  std::uint64_t issued = 0;               // s since 1970
  std::uint64_t expires = 0;              // s since 1970
  Key server{};                           // public, of the server that it is for; zeros: every one with the sealing key
  Admission admission = {};               // from: in introductions alone
};

// The longest life of a connect token or an introduction, s.
inline constexpr std::uint64_t kMaxTokenSeconds = 30;

[[nodiscard]] std::vector<std::uint8_t> SealToken(TokenKind kind, const Token& token, const Key& key,
                                                  const RandomSource& random);
// nullopt for anything but a whole token of that kind, sealed with that key. Times are not looked at.
[[nodiscard]] std::optional<Token> OpenToken(TokenKind kind, std::span<const std::uint8_t> bytes, const Key& key);
// Bytes of each introduction: its name is empty.
[[nodiscard]] std::size_t CountIntroductionBytes();

// Secrets as text: base64url without padding (RFC 4648, section 5). nullopt for anything else.
[[nodiscard]] std::string FormatSecret(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<std::vector<std::uint8_t>> ParseSecret(std::string_view text);

}  // namespace wobble::transport::vestibule
