// One player after the other is followed, whoever comes and goes.
#include "client/terminal/follow.h"

#include <gtest/gtest.h>

namespace wobble::terminal {
namespace {

TEST(Followed, OneAfterTheOtherAndThenNobody) {
  Followed followed;
  std::map<std::uint32_t, std::string> players{{3, "Ada"}, {7, "Bo"}};
  EXPECT_EQ(followed.ChooseNext(players), "follows Ada");
  EXPECT_EQ(followed.Body(), 3U);
  players.erase(3);
  EXPECT_EQ(followed.Body(), 3U) << "a recording that is wound back has her again";
  EXPECT_EQ(followed.ChooseNext(players), "follows Bo");
  EXPECT_EQ(followed.ChooseNext(players), "follows nobody");
  EXPECT_EQ(followed.Body(), 0U);
  EXPECT_EQ(followed.ChooseNext({}), "nobody to follow");
}

}  // namespace
}  // namespace wobble::terminal
