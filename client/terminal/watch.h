// `wobble watch`: a server's world in the terminal, and keys to play in it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "client/command/address.h"
#include "client/terminal/cells.h"

namespace wobble::terminal {

struct WatchOptions {
  tool::Address server;
  std::string name = "player";     // at most protocol::kMaxNameBytes bytes
  bool spectate = false;           // no body of one's own
  double fps = 30;                 // pictures a second, at most
  double duration = 0;             // seconds; 0: until told to end
  std::optional<Palette> palette;  // nullopt: as the environment says
  std::string captureFile;         // where the last picture goes as SVG; empty: nowhere
};

// By COLORTERM, or a TERM that is known for more than 256 colours.
[[nodiscard]] Palette FindPalette(const char* colorTerm, const char* term);

// Returns the exit code: 0 when it was told to end, 2 when there is no terminal or nobody to join, else 1.
[[nodiscard]] int RunWatch(const WatchOptions& options, const std::function<bool()>& isStopAsked);

}  // namespace wobble::terminal
