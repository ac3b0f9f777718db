// The calls of fleet_reconciler.h as requests to Agones' sidecar, and its answers read: the REST interface of
// agones.dev, "REST Game Server Client API", as its sdk.proto and beta.proto map it to HTTP.
#pragma once

#include <optional>
#include <string>

#include "server/ops/fleet_reconciler.h"

namespace wobble::ops {

// The name of the counter and of the list of players. The fleet must declare both; the server does not.
inline constexpr const char* kPlayersName = "players";

struct SidecarRequest {
  const char* method = "POST";  // or GET, PATCH
  std::string path;
  std::string body = "{}";  // JSON; the sidecar refuses a health call without a body
};

[[nodiscard]] SidecarRequest MakeRequest(const FleetCall& call);

// What an answer means. status: of HTTP. In `trouble`, for a log, one line that says what is wrong with the answer,
// with the sidecar's own message; empty when nothing is.
[[nodiscard]] FleetAnswer ReadAnswer(const FleetCall& call, int status, const std::string& body, std::string& trouble);

}  // namespace wobble::ops
