// When a host is told that its gateway's key may be wrong.
#include "client/gateway/key_doubts.h"

#include <gtest/gtest.h>

namespace wobble::gateway {
namespace {

using Cause = KeyDoubts::Cause;

TEST(KeyDoubts, AWrongKeyIsNamedOnceInTenSeconds) {
  KeyDoubts doubts;
  EXPECT_NE(doubts.NoteRefused("arena", Cause::kGateway, 1).find("server of arena does not know this gateway"),
            std::string::npos);
  EXPECT_EQ(doubts.NoteRefused("arena", Cause::kGateway, 10), "");
  EXPECT_NE(doubts.NoteRefused("sumo", Cause::kGateway, 10), "");
  EXPECT_NE(doubts.NoteRefused("arena", Cause::kGateway, 11), "");
}

TEST(KeyDoubts, WrongPasswordsSayNothingOfAGatewayThatIsKnown) {
  KeyDoubts doubts;
  EXPECT_NE(doubts.NoteRefused("", Cause::kPerhapsBrowser, 1).find("the server has refused a browser"),
            std::string::npos);
  doubts.NoteLetIn("");
  EXPECT_EQ(doubts.NoteRefused("", Cause::kPerhapsBrowser, 20), "");
  EXPECT_NE(doubts.NoteRefused("", Cause::kGateway, 20), "") << "it may be another server by now";
}

}  // namespace
}  // namespace wobble::gateway
