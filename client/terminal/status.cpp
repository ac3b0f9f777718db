#include "client/terminal/status.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

namespace wobble::terminal {
namespace {

constexpr Colour kInk{205, 214, 228};
constexpr Colour kFaintInk{130, 142, 162};
constexpr Colour kPaper{24, 30, 42};

// Writes a whole row.
void WriteRow(CellGrid& grid, int row, const std::string& text) {
  for (int column = 0; column < grid.columns; ++column) grid.At(column, row) = {U' ', kInk, kPaper};
  grid.Write(1, row, text, kInk, kPaper);
}

// In rows of so many columns, at spaces where there are any; all but the first are indented.
void Wrap(std::string line, std::size_t columns, std::vector<std::string>& rows) {
  constexpr std::string_view kIndent = "  ";
  while (line.size() > columns) {
    const std::size_t space = line.rfind(' ', columns);
    const bool isFound = space != std::string::npos && space > kIndent.size();
    const std::size_t end = isFound ? space : columns;
    rows.push_back(line.substr(0, end));
    line = std::string(kIndent) + line.substr(isFound ? end + 1 : end);
  }
  rows.push_back(std::move(line));
}

}  // namespace

std::string FormatStatus(const StatusFigures& figures) {
  char input[24] = "-";
  if (figures.inputMs) std::snprintf(input, sizeof input, "%.0f ms", *figures.inputMs);
  char slow[24] = "";
  if (figures.pace < 1) std::snprintf(slow, sizeof slow, "SERVER SLOW: %.0f %%  ", 100 * figures.pace);
  char text[160];
  std::snprintf(text, sizeof text, "%sinput %s  %.0f kbit/s  delay %.0f ms  %llu stalls  %zu bodies  %zu player%s",
                slow, input, figures.kbitPerSecond, figures.interpolationDelayMs,
                static_cast<unsigned long long>(figures.stalls), figures.bodies, figures.players,
                figures.players == 1 ? "" : "s");
  return text;
}

std::string FormatSilence(double seconds) {
  char text[80];
  std::snprintf(text, sizeof text, "nothing from the server for %.0f s", seconds);
  return text;
}

std::string FormatRejoining(const std::string& reason) { return "connection lost (" + reason + "); joining again ..."; }

std::string FormatField(const std::string& text, int columns) {
  const std::size_t room = columns > 8 ? static_cast<std::size_t>(columns - 8) : 0;
  return "say: " + text.substr(text.size() - std::min(room, text.size())) + "_";
}

const char* DescribeEmote(wire::EmoteKind kind) {
  switch (kind) {
    case wire::EmoteKind::Wave:
      return "waves";
    case wire::EmoteKind::Laugh:
      return "laughs";
    case wire::EmoteKind::Love:
      return "sends love";
    case wire::EmoteKind::Wow:
      return "is amazed";
    case wire::EmoteKind::Sad:
      return "is sad";
    case wire::EmoteKind::Cheer:
      return "cheers";
  }
  return "shows something";
}

void WriteStatus(CellGrid& grid, const std::string& text, const std::string& hint) {
  const int row = grid.rows - 1;
  WriteRow(grid, row, text);
  for (const std::string& words : {hint, hint.substr(0, 1)}) {
    const int left = grid.columns - 1 - static_cast<int>(words.size());
    if (left > static_cast<int>(text.size()) + 2) return grid.Write(left, row, words, kFaintInk, kPaper);
  }
}

void WriteTop(CellGrid& grid, const std::string& text) { WriteRow(grid, 0, text); }

void WriteAnswer(CellGrid& grid, const std::vector<std::string>& lines) {
  std::vector<std::string> rows;
  for (const std::string& line : lines) Wrap(line, static_cast<std::size_t>(std::max(grid.columns - 2, 8)), rows);
  const int room = std::max(grid.rows - 2, 0);
  const int first = std::max(static_cast<int>(rows.size()) - room, 0);
  int row = grid.rows - 1 - (static_cast<int>(rows.size()) - first);
  for (auto each = rows.begin() + first; each != rows.end(); ++each, ++row) WriteRow(grid, row, *each);
}

namespace {

const char* NameOfSide(int side) { return side == 1 ? "Blue" : "Red"; }

std::string DescribeWinner(const client::Scoreboard& board, const std::function<std::string(std::uint32_t)>& nameOf) {
  if (board.winningSide != 0) return std::string(NameOfSide(board.winningSide)) + " has won";
  return board.winner == 0 ? "a draw" : nameOf(board.winner) + " has won";
}

std::string DescribePhase(const client::Scoreboard& board, const std::function<std::string(std::uint32_t)>& nameOf) {
  const std::string left = std::to_string(board.secondsLeft) + " s";
  const std::string toWin = "  first to " + std::to_string(board.pointsToWin);
  switch (board.phase) {
    case wire::GamePhase::Playing:
      return left + toWin;
    case wire::GamePhase::Won:
      return DescribeWinner(board, nameOf) + "; the next begins in " + left;
    case wire::GamePhase::Lobby:
      return board.scores.size() < 2 ? "waiting for others to play with" : "Y: ready; the match begins within " + left;
    case wire::GamePhase::KickOff:
      return "kick-off in " + left + toWin;
    case wire::GamePhase::Golden:
      return left + "  the next point wins";
    case wire::GamePhase::Over:
      return "the match is over: " + DescribeWinner(board, nameOf);
  }
  return "";
}

}  // namespace

std::string FormatScores(const client::Scoreboard& board, const std::function<std::string(std::uint32_t)>& nameOf) {
  std::string text = "round " + std::to_string(board.round);
  if (board.rounds > 0) text += " of " + std::to_string(board.rounds);
  text += "  " + DescribePhase(board, nameOf);
  if (board.sides.size() == 2) {
    text +=
        "   Blue " + std::to_string(board.sides[0].points()) + " : " + std::to_string(board.sides[1].points()) + " Red";
  }
  for (std::size_t i = 0; i < board.scores.size(); ++i) {
    const wire::Score& score = board.scores[i];
    const int side = i < board.seats.size() ? board.seats[i].side() : 0;
    const bool isReady = i < board.seats.size() && board.seats[i].ready();
    text += "   " + nameOf(score.client_id());
    if (side != 0) text += side == 1 ? " (B)" : " (R)";
    text += board.phase == wire::GamePhase::Lobby ? (isReady ? " ready" : " not ready")
                                                  : " " + std::to_string(score.points());
    if (board.bearer != 0 && score.client_id() == board.bearer) text += " with the crown";
  }
  return text;
}

void WriteBox(CellGrid& grid, const std::vector<std::string>& lines) {
  std::size_t widest = 0;
  for (const std::string& line : lines) widest = std::max(widest, line.size());
  const int width = std::min(static_cast<int>(widest) + 4, grid.columns);
  const int left = (grid.columns - width) / 2;
  const int margin = static_cast<int>(lines.size()) + 2 < grid.rows ? 1 : 0;  // a margin only when there is room
  int row = std::max(0, (grid.rows - 1 - static_cast<int>(lines.size())) / 2 - margin);
  const auto write = [&](const std::string& line) {
    if (row >= grid.rows) return;
    for (int column = left; column < left + width; ++column) grid.At(column, row) = {U' ', kInk, kPaper};
    grid.Write(left + (width > 4 ? 2 : 0), row, line, kInk, kPaper);
    ++row;
  };
  if (margin > 0) write("");
  for (const std::string& line : lines) write(line);
  if (margin > 0) write("");
}

std::vector<std::string> DescribeKeys(const StatusFigures& figures, const std::vector<std::string>& hands) {
  char drawing[80];
  std::snprintf(drawing, sizeof drawing, "a picture: %.1f ms to draw, %.1f kB to send", figures.frameMs,
                figures.frameKilobytes);
  std::vector<std::string> lines{
      "W A S D, arrows  move, as seen by the camera",
      "space            jump",
      "E or P           puff up",
      "F                stiffen",
  };
  lines.insert(lines.end(), hands.begin(), hands.end());
  lines.insert(lines.end(), {
                                "X                let go of all keys",
                                "Enter            a line to all, or /order     Y  ready, before a match",
                                "",
                                "C                camera: follow, circle, stand",
                                "J L or [ ]       turn     I K  tilt     + -  zoom",
                                "?                these keys",
                                "Q, Esc, Ctrl-C   quit     Ctrl-Z  suspend",
                                "",
                                "input   time from sending a key to a snapshot with its effect",
                                "SERVER SLOW  overloaded: speed of the world",
                                "delay   time by which shown bodies lag the server",
                                "stalls  bodies whose next snapshot came late",
                                drawing,
                            });
  return lines;
}

}  // namespace wobble::terminal
