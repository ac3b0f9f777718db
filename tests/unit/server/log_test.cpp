// The server's log: whatever strangers send, no line holds a byte that a terminal obeys.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "protocol/text.h"
#include "tests/support/game.h"
#include "tests/support/log_catcher.h"

namespace wobble::server {
namespace {

using protocol::wire::GoodbyeReason;
using protocol::wire::Role;
using test::Game;
using transport::Channel;

TEST(ServerLog, HasNoByteThatATerminalObeys) {
  const test::LogCatcher caught;
  Game game(test::MakeYard());
  const std::vector<std::string> names{"Eve\x1b[2J\nroot logged in",
                                       "\xC2\x9B"
                                       "31mred",
                                       "\x9B"
                                       "31m",
                                       "a\xE2\x80\xAE"
                                       "b",
                                       "\xED\xA0\x80",
                                       "line\xE2\x80\xA8two",
                                       "\r\t\x07\x7f",
                                       "Ada",
                                       "Ada"};
  for (const std::string& name : names) {
    auto& raw = game.AddRaw();
    game.Run(0.1);
    raw.Send(Channel::kControl, protocol::MakeHello(name, Role::Player));
  }
  game.Run(0.2);
  EXPECT_EQ(game.server.CountPlaying(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    // Half of them say goodbye with a detail, the others send what is no message until they are sent away.
    if (i % 2 == 0) {
      game.raw[i]->Send(Channel::kControl, protocol::MakeClientGoodbye(GoodbyeReason::Left,
                                                                       "\x1b[2J\xC2\x9B"
                                                                       "2J\n"));
    } else {
      for (int k = 0; k < 30; ++k) game.raw[i]->Send(Channel::kControl, {0x1b, 0x5b, 0x32, 0x4a, 0x0a});
    }
  }
  game.Run(0.5);
  EXPECT_EQ(game.server.CountPlaying(), 0U);

  std::istringstream lines(caught.Text());
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_EQ(protocol::MakeLine(line, 1000), line);
  EXPECT_GE(count, 2 * static_cast<int>(names.size()));
  // No name makes a line of its own, and the second Ada is told from the first.
  EXPECT_EQ(caught.Text().find("\nroot"), std::string::npos);
  EXPECT_NE(caught.Text().find("(Eve [2J root logged in) joined"), std::string::npos);
  EXPECT_NE(caught.Text().find("(Ada 2) joined"), std::string::npos);
}

}  // namespace
}  // namespace wobble::server
