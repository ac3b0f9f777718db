// The keys of the vestibule: long-lived ones that name a server, and those that a handshake makes of them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace wobble::transport::vestibule {

// An X25519 key, public or secret, or a symmetric key.
using Key = std::array<std::uint8_t, 32>;

struct KeyPair {
  Key publicKey{};
  Key secretKey{};
};

// Fills the bytes with randomness that nobody can guess. A parameter, so that tests repeat; FillRandomly for all else.
using RandomSource = std::function<void(std::span<std::uint8_t>)>;

// False when the cryptographic library does not start. To be called before any other function here.
[[nodiscard]] bool InitialiseSodium();
void FillRandomly(std::span<std::uint8_t> bytes);
[[nodiscard]] KeyPair MakeKeyPair(const RandomSource& random);
// The pair of a secret key from a file.
[[nodiscard]] KeyPair MakeKeyPair(const Key& secretKey);

// The keys of one session. The two directions have different ones, so that a datagram cannot be sent back to where it
// came from; `control` is for what the server's vestibule itself says, which counts its datagrams separately.
struct SessionKeys {
  Key toServer{};
  Key toClient{};
  Key control{};
};

// Both ends compute the same keys, from Diffie–Hellman products of the client's key with the server's long-lived key,
// which proves to the client who answers, and with the key that the server made when it started, so that recordings
// stay closed once that one is gone and no session's keys come back after a restart. nullopt: a key is of low order.
[[nodiscard]] std::optional<SessionKeys> DeriveAsClient(const KeyPair& client, const Key& server, const Key& started);
[[nodiscard]] std::optional<SessionKeys> DeriveAsServer(const KeyPair& server, const KeyPair& started,
                                                        const Key& client);

// The first bytes of a keyed hash (BLAKE2b). hash: 16 to 64 bytes.
void ComputeHash(std::span<std::uint8_t> hash, std::span<const std::uint8_t> key,
                 std::span<const std::uint8_t> message);
// Whether two secrets are equal, in a time that tells nothing about where they differ.
[[nodiscard]] bool AreEqual(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

// 64 hexadecimal digits. ParseKey: nullopt for anything else.
[[nodiscard]] std::string FormatKey(const Key& key);
[[nodiscard]] std::optional<Key> ParseKey(std::string_view text);

}  // namespace wobble::transport::vestibule
