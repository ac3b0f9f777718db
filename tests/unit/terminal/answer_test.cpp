// An answer of several lines.
#include "client/terminal/answer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/terminal/status.h"

namespace wobble::terminal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Answer, LinesThatComeTogetherAreShownTogetherAndLongEnoughToRead) {
  Answer answer;
  EXPECT_THAT(answer.Read(0), IsEmpty());
  answer.Add("1 mira", 10);
  answer.Add("2 otto", 10.1);
  EXPECT_THAT(answer.Read(10.2), ElementsAre("1 mira", "2 otto"));
  EXPECT_THAT(answer.Read(14.5), ElementsAre("1 mira", "2 otto"));
  EXPECT_THAT(answer.Read(14.7), IsEmpty());
  answer.Add("next", 12);
  EXPECT_THAT(answer.Read(12), ElementsAre("next")) << "the line of another answer";
  EXPECT_THAT(answer.Read(15.9), ElementsAre("next"));
  EXPECT_THAT(answer.Read(16.1), IsEmpty());
  for (int i = 0; i < 1000; ++i) answer.Add("again", 20);
  EXPECT_LE(answer.Read(20).size(), 100U) << "of a server that never stops";
}

std::string ReadRow(const CellGrid& grid, int row) {
  std::string text;
  for (int column = 0; column < grid.columns; ++column) text += static_cast<char>(grid.At(column, row).glyph);
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

TEST(Answer, IsWrittenAboveTheStatusLineAndWrapped) {
  CellGrid grid;
  grid.Resize(20, 6);
  WriteAnswer(grid, {"one", "a line of thirty-one characters"});
  EXPECT_EQ(ReadRow(grid, 0), "") << "the score's";
  EXPECT_EQ(ReadRow(grid, 1), " one");
  EXPECT_EQ(ReadRow(grid, 2), " a line of");
  EXPECT_EQ(ReadRow(grid, 3), "   thirty-one");
  EXPECT_EQ(ReadRow(grid, 4), "   characters");
  EXPECT_EQ(ReadRow(grid, 5), "") << "the status line";
}

TEST(Answer, OfMoreLinesThanThereAreRowsLosesTheFirst) {
  CellGrid grid;
  grid.Resize(20, 4);
  WriteAnswer(grid, {"one", "two", "three", "four"});
  EXPECT_EQ(ReadRow(grid, 0), "");
  EXPECT_EQ(ReadRow(grid, 1), " three");
  EXPECT_EQ(ReadRow(grid, 2), " four");
}

}  // namespace
}  // namespace wobble::terminal
