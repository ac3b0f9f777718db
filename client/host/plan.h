// What a fleet runs: worlds, a gateway for browsers, and bots. `wobble play` makes it from its options, `wobble host`
// from a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/command/show_page.h"

namespace wobble::host {

struct BotsPlan {
  unsigned count = 0;
  std::string script = "wander.lua";
  std::vector<std::string> access;  // options with which they come in

  bool operator==(const BotsPlan&) const = default;
};

// A server of its own.
struct WorldPlan {
  std::string name;                  // letters, digits, - and _: as the page shows it
  std::string title;                 // in messages: "server of sumo"
  std::string label;                 // before its scene in the line that says where it is: "world sumo, "
  std::string host = "127.0.0.1";    // at which gateway and bots find it; an IPv6 address in brackets
  std::uint16_t port = 0;            // UDP; 0: a free one, which it keeps
  std::vector<std::string> options;  // of wobbled, without --port, --status and --summary
  std::filesystem::path state;       // folder to be made for it; empty: none
  BotsPlan bots;

  bool operator==(const WorldPlan&) const = default;
};

struct GatewayPlan {
  std::uint16_t port = command::kPagePort;  // TCP; 0: a free one, which it keeps
  std::string bindAddress = "0.0.0.0";
  std::vector<std::string> options;  // of `wobble gateway`, without --http, --bind, --server and --status

  bool operator==(const GatewayPlan&) const = default;
};

struct Plan {
  std::string command;                  // before messages: "wobble play"
  std::filesystem::path programFolder;  // where wobbled and wobble lie
  std::vector<WorldPlan> worlds;        // one at least
  std::optional<GatewayPlan> gateway;
  std::string notice;      // to be said once all is ready; empty: nothing
  double duration = 0;     // seconds from when all is ready; 0: until stopped
  double statusEvery = 1;  // seconds; 0: no status lines
};

}  // namespace wobble::host
