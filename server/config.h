// What a server can be told, with the ranges that hold.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/scenes/scene.h"

namespace wobble::server {

struct Range {
  double low = 0, high = 0;
};
inline constexpr Range kPortRange{0, 65535};  // 0: a free one
inline constexpr Range kTickHzRange{10, 480};
inline constexpr Range kSnapshotHzRange{1, 480};  // and at most tickHz
inline constexpr Range kMaxClientsRange{1, 4000};
inline constexpr Range kMaxPerAddressRange{0, 4000};
inline constexpr Range kRoundsRange{0, 1000};
inline constexpr Range kThreadsRange{1, 256};
inline constexpr Range kClientKbitRange{32, 100000};
inline constexpr Range kPauseAfterRange{0, 1e6};    // s
inline constexpr Range kViewDistanceRange{1, 1e5};  // m

struct Config {
  std::uint16_t port = 7777;  // UDP
  int tickHz = 60;
  int snapshotHz = 30;
  int maxClients = 64;
  int maxPerAddress = 0;  // 0: as many as clients
  int threads = 1;
  double clientKbit = 384;      // a client's share of snapshots, kbit/s, all headers counted
  double viewDistance = 250;    // from a player's own body within which others are sent, m
  double pauseAfter = 30;       // seconds that a world without a single connection goes on for; 0: always
  bool admitsWhenBusy = false;  // lets players in although there is too little time for ticks
  int rounds = 0;               // of the scene's game that make a match; 0: it has no end
  std::uint64_t seed = 1;
};

// Every option out of range and everything in the scene that the protocol cannot carry, a line each.
[[nodiscard]] std::vector<std::string> Validate(const Config& config, const scenes::Scene& scene);

}  // namespace wobble::server
