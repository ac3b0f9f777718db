// `wobble play`: a fleet for one machine from a few options: some worlds, the gateway for browsers and some bots.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/command/show_page.h"

namespace wobble::play {

struct PlayOptions {
  std::filesystem::path programFolder;  // where wobbled and wobble lie
  // A server each. The first has the bots; the others wait until somebody comes.
  std::vector<std::string> scenes{"arena", "sumo", "curtain", "sandbox"};
  std::uint16_t port = 7777;  // UDP, of the first server; the others have those behind it. 0: free ones
  std::optional<std::uint16_t> http = command::kPagePort;  // of the gateway, 0: a free one; nullopt: no gateway
  std::filesystem::path page;                              // folder of its page; no gateway where there is none
  std::string recordings;  // folder to record all worlds in and to show on the page; empty: none
  std::string state;       // folder to keep the worlds in; empty: they end with this program
  unsigned bots = 6;
  double duration = 0;  // seconds from when all is ready; 0: until stopped
};

// Until the time is up, stopAsked is true or no world is left. Returns the exit code of RunFleet.
[[nodiscard]] int RunPlay(const PlayOptions& options, const std::function<bool()>& stopAsked);

}  // namespace wobble::play
