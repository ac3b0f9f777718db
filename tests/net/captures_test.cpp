// Captures a picture of every shipped scene with `wobble watch` into the build folder's captures/. Whether a picture
// shows what the scene describes is judged by people; this test checks that bodies are visible at all.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/places.h"
#include "tests/support/watching.h"

namespace wobble::test {
namespace {

constexpr double kShown = 3;  // seconds until dropped bodies have landed and driven ones move
constexpr int kWidth = 110;
constexpr int kHeight = 32;

std::vector<std::string> FindScenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(FindSource("server/scenes"))) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// Ground and walls are blue or dark; bodies without a player are grey and lit.
bool IsOfABody(terminal::Colour colour) { return colour.red >= 70 && colour.blue <= colour.red + 8; }

// Counts half cells, without the row of figures.
int CountBodyPixels(const Screen& screen) {
  int count = 0;
  for (int row = 0; row + 1 < screen.Grid().rows; ++row) {
    for (int column = 0; column < screen.Grid().columns; ++column) {
      const terminal::Cell& cell = screen.Grid().At(column, row);
      const bool isText = cell.glyph != terminal::kUpperHalf && cell.glyph != U' ';
      if (!isText && IsOfABody(cell.background)) ++count;
      if (cell.glyph == terminal::kUpperHalf ? IsOfABody(cell.foreground) : !isText && IsOfABody(cell.background)) {
        ++count;
      }
    }
  }
  return count;
}

// False for a world whose only bodies are players; such a world is captured with one.
bool HasBodies(const std::string& scene) {
  const std::filesystem::path file = FindSource("server/scenes/" + scene + ".toml");
  return ReadWhole(file).find("[[bodies]]") != std::string::npos;
}

class Captures : public testing::TestWithParam<std::string> {};

TEST_P(Captures, ShowsItsBodies) {
  const std::filesystem::path folder = FindCaptures();
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / (GetParam() + ".svg");
  std::filesystem::remove(file);

  const Wobbled server(GetParam());
  std::vector<std::string> options{"--fps", "10", "--capture", file};
  if (HasBodies(GetParam())) options.push_back("--spectate");
  Session session(Watching(server.Port(), options), "truecolor", kWidth, kHeight);
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  for (const double end = ReadClock() + kShown; ReadClock() < end;) session.Take(20);
  EXPECT_TRUE(session.Await([&] { return CountBodyPixels(session.Shown()) >= 40; }))
      << CountBodyPixels(session.Shown()) << " half cells of bodies";
  EXPECT_NE(session.Status().find("kbit/s"), std::string::npos) << session.Status();
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  const std::string picture = ReadWhole(file);
  EXPECT_EQ(picture.rfind("<svg ", 0), 0U);
  EXPECT_NE(picture.find("</svg>"), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(All, Captures, testing::ValuesIn(FindScenes()),
                         [](const auto& parameter) { return parameter.param; });

}  // namespace
}  // namespace wobble::test
