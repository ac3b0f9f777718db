// `wobble watch`: draws a server's world in the terminal and plays in it by keys.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "client/command/address.h"
#include "client/rejoin.h"
#include "client/terminal/cells.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::terminal {

struct WatchOptions {
  command::Address server;
  transport::ConnectOptions access;  // password and the server's key
  std::string name = "player";       // at most protocol::kMaxNameBytes bytes
  bool spectate = false;             // without a body
  client::RejoinOptions rejoin;      // when it was cut off
  double fps = 30;                   // pictures per second, at most
  double duration = 0;               // seconds; 0: until the user ends it
  std::optional<Palette> palette;    // nullopt: chosen by FindPalette
  std::string captureFile;           // file for the last picture as SVG; empty: none
};

// True colour by COLORTERM, or by a TERM known for more than 256 colours. Both may be null.
[[nodiscard]] Palette FindPalette(const char* colorTerm, const char* term);

// Returns the exit code: 0 when the user ended it, 2 when there is no terminal or no server to join, else 1.
[[nodiscard]] int RunWatch(const WatchOptions& options, const std::function<bool()>& isStopAsked);

}  // namespace wobble::terminal
