// What a film's server says of it, as a line of time.
#include "client/terminal/film.h"

#include <gtest/gtest.h>

namespace wobble::terminal {
namespace {

TEST(TerminalFilm, ReadsWhereItStands) {
  const auto plays = ReadPlace("plays 1:03.2 of 12:32.0, speed -0.5, tick 3792, on the way to 2:00.0");
  ASSERT_TRUE(plays);
  EXPECT_TRUE(plays->isPlaying);
  EXPECT_NEAR(plays->time, 63.2, 1e-9);
  EXPECT_NEAR(plays->end, 752, 1e-9);
  EXPECT_EQ(plays->speed, -0.5);
  const auto paused = ReadPlace("paused at 0:00.0 of 0:02.5, speed 16, tick 0");
  ASSERT_TRUE(paused);
  EXPECT_FALSE(paused->isPlaying);
  for (const char* other : {"", "plays", "Ada fell off", "paused at dawn of 3", "plays 1:x of 2:3, speed 1"}) {
    EXPECT_FALSE(ReadPlace(other)) << other;
  }
}

TEST(TerminalFilm, DrawsALineOfTime) {
  FilmKeys keys;
  EXPECT_EQ(keys.MakeLine(40), "");
  EXPECT_FALSE(keys.TakeNotice("the world begins anew"));
  EXPECT_TRUE(keys.TakeNotice("plays 0:30.0 of 1:00.0, speed 4, tick 1800"));
  const std::string line = keys.MakeLine(60);
  EXPECT_EQ(line.size(), 60U);
  EXPECT_NE(line.find("=>-"), std::string::npos);
  EXPECT_TRUE(line.ends_with(" 0:30 of 1:00, plays x4")) << line;
  EXPECT_EQ(keys.MakeLine(10), " 0:30 of 1:00, plays x4") << "no room for a bar";
}

}  // namespace
}  // namespace wobble::terminal
