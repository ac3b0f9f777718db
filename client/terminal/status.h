// Words on the screen: the status line, the keys, and messages instead of a picture.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/terminal/cells.h"

namespace wobble::terminal {

struct StatusFigures {
  std::optional<double> inputMs;    // from sending an input to the first snapshot of a world that has used it
  double kbitPerSecond = 0;         // received, all headers above UDP's included
  double interpolationDelayMs = 0;  // how far behind the server's time bodies are shown
  double pace = 1;                  // of the world, Client::Pace
  std::uint64_t stalls = 0;         // times that a body was shown without anything new in time
  std::size_t bodies = 0;           // shown
  std::size_t players = 0;          // with a body
  double frameMs = 0;               // to draw a picture, mean of the last few
  double frameKilobytes = 0;        // sent to the terminal for it
};

// Fits 79 columns as long as no figure is out of all proportion.
[[nodiscard]] std::string FormatStatus(const StatusFigures& figures);

// Instead of it, when nothing came for so long.
[[nodiscard]] std::string FormatSilence(double seconds);

// In the last row; the hint at its right end, or the key alone that it begins with, if there is room.
void WriteStatus(CellGrid& grid, const std::string& text, const std::string& hint);
// In the first row.
void WriteTop(CellGrid& grid, const std::string& text);
// In a box in the middle.
void WriteBox(CellGrid& grid, const std::vector<std::string>& lines);

// hands: lines of keys that not every server has a use for.
[[nodiscard]] std::vector<std::string> DescribeKeys(const StatusFigures& figures,
                                                    const std::vector<std::string>& hands = {});

// How a game stands, the best first.
[[nodiscard]] std::string FormatScores(const client::Scoreboard& board,
                                       const std::function<std::string(std::uint32_t)>& nameOf);

}  // namespace wobble::terminal
