// The log of those who are not let in: it shows guesses at once, and a flood of them in a line in ten seconds.
#include "server/admission/refusal_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/log_catcher.h"
#include "tests/unit/vestibule/deterministic.h"

namespace wobble::admission {
namespace {

using transport::Turnaway;

TEST(RefusalLog, HasALineAtOnceAndThenOneInTenSecondsWithCounts) {
  const test::LogCatcher caught;
  RefusalLog log;
  transport::Statistics statistics;
  const auto refuse = [&](Turnaway why, std::uint8_t host) {
    auto& counted = statistics.turnaways[static_cast<std::size_t>(why)];
    ++counted.count;
    counted.last = transport::vestibule::MakeAddress(192, 0, 2, host, 1);
  };
  log.Follow(statistics, 1);
  EXPECT_EQ(caught.Text(), "");
  refuse(Turnaway::kPassword, 7);
  log.Follow(statistics, 2);
  EXPECT_EQ(caught.Text(), "not let in: wrong password (1, last from 192.0.2.7)\n");
  for (int i = 0; i < 1000; ++i) {
    refuse(Turnaway::kPassword, static_cast<std::uint8_t>(1 + i % 9));
    log.Follow(statistics, 2 + 0.009 * i);
  }
  refuse(Turnaway::kBanned, 4);
  log.Follow(statistics, 12);
  log.Follow(statistics, 30);
  const std::string text = caught.Text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  EXPECT_NE(text.find("wrong password (1000, last from 192.0.2.1), banned (1, last from 192.0.2.4)"), std::string::npos)
      << text;
}

TEST(RefusalLog, TheHostIsToldOfAGatewayWithAnotherKey) {
  const test::LogCatcher caught;
  RefusalLog log;
  transport::Statistics statistics;
  statistics.turnaways[static_cast<std::size_t>(Turnaway::kGateway)] = {
      3, transport::vestibule::MakeAddress(192, 0, 2, 7, 1)};
  log.Follow(statistics, 1);
  EXPECT_NE(caught.Text().find("gateway at 192.0.2.7 was refused 3 times"), std::string::npos) << caught.Text();
}

}  // namespace
}  // namespace wobble::admission
