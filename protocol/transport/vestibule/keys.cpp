// X25519 and BLAKE2b of libsodium. The derivation is a hash over both products and all public keys, as in Noise:
// whoever changes any of them on the way gets other keys.
#include "protocol/transport/vestibule/keys.h"

#include <sodium.h>

#include <cassert>
#include <cstring>

namespace wobble::transport::vestibule {
namespace {

constexpr char kContext[] = "wobble vestibule 1";

// products: of the client's key with the server's two keys.
SessionKeys Derive(const Key& withServer, const Key& withStarted, const Key& client, const Key& server,
                   const Key& started) {
  SessionKeys keys;
  Key* const wanted[] = {&keys.toServer, &keys.toClient, &keys.control};
  for (std::uint8_t i = 0; i < 3; ++i) {
    crypto_generichash_state state;
    crypto_generichash_init(&state, nullptr, 0, sizeof(Key));
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(kContext), sizeof kContext);
    crypto_generichash_update(&state, &i, 1);
    for (const Key* part : {&withServer, &withStarted, &client, &server, &started}) {
      crypto_generichash_update(&state, part->data(), part->size());
    }
    crypto_generichash_final(&state, wanted[i]->data(), wanted[i]->size());
  }
  return keys;
}

bool Multiply(Key& product, const Key& secret, const Key& other) {
  return crypto_scalarmult(product.data(), secret.data(), other.data()) == 0;
}

}  // namespace

bool InitialiseSodium() {
  static const bool isReady = sodium_init() >= 0;
  return isReady;
}

void FillRandomly(std::span<std::uint8_t> bytes) { randombytes_buf(bytes.data(), bytes.size()); }

KeyPair MakeKeyPair(const RandomSource& random) {
  Key secret;
  random(secret);
  return MakeKeyPair(secret);
}

KeyPair MakeKeyPair(const Key& secretKey) {
  KeyPair pair;
  pair.secretKey = secretKey;
  crypto_scalarmult_base(pair.publicKey.data(), secretKey.data());
  return pair;
}

std::optional<SessionKeys> DeriveAsClient(const KeyPair& client, const Key& server, const Key& started) {
  Key withServer, withStarted;
  if (!Multiply(withServer, client.secretKey, server) || !Multiply(withStarted, client.secretKey, started)) return {};
  return Derive(withServer, withStarted, client.publicKey, server, started);
}

std::optional<SessionKeys> DeriveAsServer(const KeyPair& server, const KeyPair& started, const Key& client) {
  Key withServer, withStarted;
  if (!Multiply(withServer, server.secretKey, client) || !Multiply(withStarted, started.secretKey, client)) return {};
  return Derive(withServer, withStarted, client, server.publicKey, started.publicKey);
}

void ComputeHash(std::span<std::uint8_t> hash, std::span<const std::uint8_t> key,
                 std::span<const std::uint8_t> message) {
  assert(hash.size() >= crypto_generichash_BYTES_MIN && hash.size() <= crypto_generichash_BYTES_MAX);
  crypto_generichash(hash.data(), hash.size(), message.data(), message.size(), key.data(), key.size());
}

bool AreEqual(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string FormatKey(const Key& key) {
  std::string text(2 * key.size() + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), key.data(), key.size());
  text.pop_back();
  return text;
}

std::optional<Key> ParseKey(std::string_view text) {
  Key key;
  std::size_t bytes = 0;
  const char* end = nullptr;
  const int result = sodium_hex2bin(key.data(), key.size(), text.data(), text.size(), nullptr, &bytes, &end);
  const bool isWhole = result == 0 && bytes == key.size() && end == text.data() + text.size();
  return isWhole ? std::optional(key) : std::nullopt;
}

}  // namespace wobble::transport::vestibule
