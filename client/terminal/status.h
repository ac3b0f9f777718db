// Text on the screen: the status line, the list of keys, and messages in place of a picture.
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
  std::optional<double> inputMs;    // from sending an input to the first snapshot that includes its effect
  double kbitPerSecond = 0;         // received, all headers above UDP included
  double interpolationDelayMs = 0;  // by which shown bodies lag the server's time
  double pace = 1;                  // world time per real time, Client::Pace
  std::uint64_t stalls = 0;         // how often a body was shown without new data in time
  std::size_t bodies = 0;           // shown
  std::size_t players = 0;          // that have a body
  double frameMs = 0;               // to draw a picture, smoothed mean
  double frameKilobytes = 0;        // sent to the terminal per picture, smoothed mean
};

// Fits 79 columns for realistic figures.
[[nodiscard]] std::string FormatStatus(const StatusFigures& figures);

// Replaces the status line after so many seconds without a snapshot.
[[nodiscard]] std::string FormatSilence(double seconds);

// Replaces the status line while the connection is lost and it tries to join again.
[[nodiscard]] std::string FormatRejoining(const std::string& reason);

// Replaces the status line while a line is written: the end of it that fits a row of so many columns.
[[nodiscard]] std::string FormatField(const std::string& text, int columns);

// Behind a player's name.
[[nodiscard]] const char* DescribeEmote(wire::EmoteKind kind);

// Writes the last row. The hint stands at its right end, shortened to the key it begins with when there is little room.
void WriteStatus(CellGrid& grid, const std::string& text, const std::string& hint);
// Writes the first row.
void WriteTop(CellGrid& grid, const std::string& text);
// Writes lines above the last row and below the first, wrapped; when there are too many, the last of them.
void WriteAnswer(CellGrid& grid, const std::vector<std::string>& lines);
// Writes a box in the middle.
void WriteBox(CellGrid& grid, const std::vector<std::string>& lines);

// hands: lines for keys that only some servers allow.
[[nodiscard]] std::vector<std::string> DescribeKeys(const StatusFigures& figures,
                                                    const std::vector<std::string>& hands = {});

// The scores of a game, the best first.
[[nodiscard]] std::string FormatScores(const client::Scoreboard& board,
                                       const std::function<std::string(std::uint32_t)>& nameOf);

}  // namespace wobble::terminal
