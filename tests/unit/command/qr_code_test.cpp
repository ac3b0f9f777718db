#include "client/command/qr_code.h"

#include <gtest/gtest.h>

namespace wobble::command {
namespace {

constexpr std::string_view kBegin = "\x1b[38;5;16;48;5;231m", kEnd = "\x1b[0m";

// The modules, true where dark, two rows of them for each line. Fails where a line is not black on white.
std::vector<std::vector<bool>> ReadModules(const std::vector<std::string>& lines) {
  std::vector<std::vector<bool>> rows;
  for (const std::string& line : lines) {
    EXPECT_TRUE(line.starts_with(kBegin) && line.ends_with(kEnd));
    std::string_view text(line);
    text = text.substr(kBegin.size(), text.size() - kBegin.size() - kEnd.size());
    std::vector<bool> above, below;
    while (!text.empty()) {
      const bool isFull = text.starts_with("█"), isUpper = text.starts_with("▀"), isLower = text.starts_with("▄");
      EXPECT_TRUE(isFull || isUpper || isLower || text[0] == ' ');
      above.push_back(isFull || isUpper);
      below.push_back(isFull || isLower);
      text.remove_prefix(text[0] == ' ' ? 1 : 3);
    }
    rows.push_back(above);
    rows.push_back(below);
  }
  return rows;
}

// Seven modules square: a dark frame, a light one, a dark heart.
bool IsFinder(const std::vector<std::vector<bool>>& rows, std::size_t top, std::size_t left) {
  for (std::size_t y = 0; y < 7; ++y) {
    for (std::size_t x = 0; x < 7; ++x) {
      const std::size_t fromEdge = std::min({x, y, 6 - x, 6 - y});
      if (rows[top + y][left + x] != (fromEdge != 1)) return false;
    }
  }
  return true;
}

TEST(QrCode, HasAQuietZoneAndThreeFinders) {
  const std::vector<std::string> lines = DrawQrCode("http://192.168.1.5:8080/");
  const auto rows = ReadModules(lines);
  constexpr std::size_t kWidth = 25 + 2 * 4;  // version 2 holds 32 bytes
  ASSERT_EQ(rows.size(), kWidth + 1);
  EXPECT_EQ(MeasureQrCode(lines), rows.size());
  for (std::size_t y = 0; y < rows.size(); ++y) {
    ASSERT_EQ(rows[y].size(), kWidth);
    for (std::size_t x = 0; x < kWidth; ++x) {
      const bool isQuiet = std::min({x, y, kWidth - 1 - x}) < 4 || y >= kWidth - 4;
      EXPECT_FALSE(isQuiet && rows[y][x]) << x << ", " << y;
    }
  }
  EXPECT_TRUE(IsFinder(rows, 4, 4));
  EXPECT_TRUE(IsFinder(rows, 4, 4 + 18));
  EXPECT_TRUE(IsFinder(rows, 4 + 18, 4));
  EXPECT_FALSE(IsFinder(rows, 4 + 18, 4 + 18));
}

TEST(QrCode, WhatDoesNotFitGivesNone) {
  EXPECT_TRUE(DrawQrCode("").empty());
  EXPECT_TRUE(DrawQrCode(std::string(3000, 'x')).empty());
  EXPECT_FALSE(DrawQrCode(std::string(2900, 'x')).empty());
}

}  // namespace
}  // namespace wobble::command
