// The administration's orders: a line of words in, lines of text out. The Unix socket, HTTP and players' own clients
// all end here.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/admission/gate.h"
#include "server/server.h"

namespace wobble::admin {

// What orders act on.
struct Realm {
  server::Server& server;
  admission::Gate& gate;
};

struct Issuer {
  transport::Rank rank = transport::Rank::kOwner;
  server::ClientId client = 0;             // 0: from outside the game
  const char* way = "the administration";  // that it came, for the log; only from outside the game
};

struct Answer {
  bool isDone = false;  // false: the lines say why not
  std::vector<std::string> lines;
};

// now: of the server's clock, s. Never throws; a line of any bytes is fine.
[[nodiscard]] Answer CarryOut(const Realm& realm, const Issuer& issuer, const std::string& line, double now);

// "90s", "15m", "2h", "7d", or "ever", which is 0; nullopt for anything else, and for more than ten years. s.
[[nodiscard]] std::optional<std::uint64_t> ParseSpan(const std::string& text);

}  // namespace wobble::admin
