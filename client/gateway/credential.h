// Reads what a browser shows to be let in, and passes it on to the server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "client/gateway/server_link.h"
#include "protocol/transport/vestibule/handshake.h"

namespace wobble::gateway {

// An introduction and this fit into vestibule::kMaxCredentialBytes; no token, invite or password needs more.
inline constexpr std::size_t kMaxBrowserCredentialBytes = 300;

// Finds the credential among the subprotocols of a WebSocket, such as "wobble.6, password.dHVsaXA": password,
// invite, token or owner, and its bytes in base64url. None is Kind::kNone. nullopt: it is malformed, or there are two.
[[nodiscard]] std::optional<transport::vestibule::Credential> FindCredential(std::string_view subprotocols);

// Finds the key of a player's lanes among them, as "more." and base64url. nullopt: there is none.
[[nodiscard]] std::optional<LaneKey> FindLaneKey(std::string_view subprotocols);

// Puts an introduction in front of the credential that says the browser's address: for servers that have the key.
// address: as SpellAddress has it. now: s since 1970.
[[nodiscard]] transport::vestibule::Credential Introduce(const transport::vestibule::Credential& own,
                                                         const std::string& address,
                                                         const transport::vestibule::Key& gatewayKey,
                                                         std::uint64_t now);

}  // namespace wobble::gateway
