// The configuration of a server, with the range of each field.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/scenes/scene.h"

namespace wobble::server {

// Inclusive.
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

// What follows when Config::rounds rounds have been played.
enum class AfterMatch : std::uint8_t {
  kEnd,      // the server ends, or its fleet manager is told
  kRestart,  // the world begins anew, and with it the next match
  kNext,     // the next scene of the rotation begins
};

// Each field is an option of the command line (options.cpp).
struct Config {
  std::uint16_t port = 7777;  // UDP
  int tickHz = 60;
  int snapshotHz = 30;
  int maxClients = 64;
  int maxPerAddress = 0;  // connections from one IP address; 0: as many as maxClients
  int threads = 1;
  double clientKbit = 4000;     // the most that a client's snapshots take, kbit/s, all headers counted (link_room.h)
  double viewDistance = 250;    // bodies farther from a player's own are not sent, m
  double pauseAfter = 30;       // the world pauses when nobody has been connected for this long, s; 0: never
  bool admitsWhenBusy = false;  // lets clients in even at LoadLevel::kBusy
  int rounds = 0;               // rounds of the scene's game that make a match; 0: it never ends
  AfterMatch afterMatch = AfterMatch::kEnd;
  bool forbidsChat = false;      // players say no lines to one another
  bool resetsWhenEmpty = false;  // the world begins anew when the last client has left
  std::uint64_t seed = 1;        // of the scene's random placement
};

// Lists every option out of range and everything in the scenes that the protocol cannot carry, one line each with value
// and range. Empty: valid. scenes: those of the rotation, or the one scene there is.
[[nodiscard]] std::vector<std::string> Validate(const Config& config, std::span<const scenes::Scene> scenes);
[[nodiscard]] inline std::vector<std::string> Validate(const Config& config, const scenes::Scene& scene) {
  return Validate(config, std::span(&scene, 1));
}

}  // namespace wobble::server
