// The datagrams of the handshake, byte by byte; STANDARD.md, section 1, has the same.
//
//   client                                            server
//     | -- Request: version, client's key, padding ----> |  no state, no key agreement
//     | <- Challenge: cookie, server's two keys -------- |  never longer than the request
//     | -- Response: cookie, key, sealed credential, --> |  only whoever has the address can have the cookie
//     |    and ENet's first datagram, sealed             |
//     | <- Accepted or Refused, sealed as control ------ |
//     | <= ENet's datagrams, sealed as data ===========> |
//
// A request may come from a forged address, so the server answers it from the request alone and with fewer bytes. The
// cookie is a keyed hash over address, key and time: it proves the address without a memory of the request.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/transport/net_address.h"
#include "protocol/transport/vestibule/keys.h"

namespace wobble::transport::vestibule {

// Raised whenever one of these datagrams changes; apart from the protocol's version, which the hello checks.
inline constexpr std::uint8_t kVestibuleVersion = 1;

// The first byte of each datagram that is not sealed. Sealed ones begin with a SealedKind.
enum class OpenKind : std::uint8_t { kRequest = 1, kChallenge = 2, kResponse = 3, kOtherVersion = 4, kReset = 5 };

using Cookie = std::array<std::uint8_t, 16>;
using ResetToken = std::array<std::uint8_t, 16>;
// The first bytes of the client's key, in answers that are not sealed: whoever does not see the client's datagrams
// cannot forge an answer.
using Echo = std::array<std::uint8_t, 8>;
[[nodiscard]] Echo MakeEcho(const Key& client);

// Longer than each answer to it, by padding.
inline constexpr std::size_t kRequestBytes = 128;
struct Request {
  std::uint8_t version = kVestibuleVersion;
  Key client{};
};
void Write(const Request& request, std::vector<std::uint8_t>& out);

struct Challenge {
  Echo echo{};
  std::uint8_t epoch = 0;  // low byte of the time at which the cookie was made, in units of kEpochSeconds
  Cookie cookie{};
  Key server{};   // long-lived, names the server
  Key started{};  // made when the server started
  bool wantsCredential = false;
};
void Write(const Challenge& challenge, std::vector<std::uint8_t>& out);

// A server of another vestibule version: its version.
struct OtherVersion {
  Echo echo{};
  std::uint8_t version = 0;
};
void Write(const OtherVersion& other, std::vector<std::uint8_t>& out);

// What a client shows to be let in; sealed in the response.
struct Credential {
  // kToken: a connect token or a ticket (token.h). kIntroduced: an introduction, and behind it the browser's own
  // credential, kind and bytes.
  enum class Kind : std::uint8_t {
    kNone = 0,
    kPassword = 1,
    kToken = 2,
    kInvite = 3,
    kOwnerKey = 4,
    kIntroduced = 5,
  };
  Kind kind = Kind::kNone;
  std::vector<std::uint8_t> bytes;  // at most kMaxCredentialBytes
};
inline constexpr std::size_t kMaxCredentialBytes = 512;

// Views of the datagram that it was read from.
struct Response {
  std::uint8_t epoch = 0;
  Cookie cookie{};
  Key client{};
  std::span<const std::uint8_t> credential;  // sealed with number 1
  std::span<const std::uint8_t> first;       // a sealed datagram of ENet, or empty
};
void Write(const Response& response, std::vector<std::uint8_t>& out);

// Sealed as control. Accepted: the session's number stands in its head.
enum class Refusal : std::uint8_t {
  kNone = 0,
  kFull = 1,
  kTooManyFromAddress = 2,
  kBadCredential = 3,
  kBanned = 4,
};
struct Answer {
  Refusal refusal = Refusal::kNone;
  ResetToken reset{};                     // of an accepted client
  std::vector<std::uint8_t> ticket = {};  // likewise, to come back with as a token; at most kMaxCredentialBytes
};
void Write(const Answer& answer, std::vector<std::uint8_t>& plain);

// A server that does not know a session any more says so; only the client of that session can know its token.
struct Reset {
  std::uint32_t session = 0;
  ResetToken token{};
};
void Write(const Reset& reset, std::vector<std::uint8_t>& out);

// nullopt for anything but a whole datagram of that kind. A request must have kRequestBytes at least.
[[nodiscard]] std::optional<Request> ReadRequest(std::span<const std::uint8_t> datagram);
[[nodiscard]] std::optional<Challenge> ReadChallenge(std::span<const std::uint8_t> datagram);
[[nodiscard]] std::optional<OtherVersion> ReadOtherVersion(std::span<const std::uint8_t> datagram);
[[nodiscard]] std::optional<Response> ReadResponse(std::span<const std::uint8_t> datagram);
[[nodiscard]] std::optional<Answer> ReadAnswer(std::span<const std::uint8_t> plain);
[[nodiscard]] std::optional<Reset> ReadReset(std::span<const std::uint8_t> datagram);

// The plain bytes of a credential, and back; nullopt: an unknown kind or too many bytes.
[[nodiscard]] std::vector<std::uint8_t> WriteCredential(const Credential& credential);
[[nodiscard]] std::optional<Credential> ReadCredential(std::span<const std::uint8_t> plain);

}  // namespace wobble::transport::vestibule
