// What a server's vestibule knows of a client that it has let in, beside its connection.
#pragma once

#include <array>
#include <cstdint>

#include "protocol/transport/net_address.h"

namespace wobble::transport {

// What a client may do; wire::Rank has the same values and says more.
enum class Rank : std::uint8_t { kWatcher = 0, kPlayer = 1, kModerator = 2, kOwner = 3 };

// Plain bytes, because it passes from the vestibule's thread to the server's as such.
struct Admission {
  Rank rank = Rank::kPlayer;
  std::uint32_t invite = 0;     // the number of the invite that it came with; 0: none
  std::uint64_t account = 0;    // who it is for the one who gave it its token; 0: not said
  std::array<char, 32> name{};  // that its token gives it, ended by a zero unless it fills it; empty: its own choice
  NetAddress from = {};         // its address; for a browser the one that its gateway saw. All zeros: not known
  // The same each time that it comes with its ticket, and of nobody else: a hash of the ticket's number, which is
  // sealed in it. All zeros: it was given no ticket.
  std::array<std::uint8_t, 16> identity{};
};

}  // namespace wobble::transport
