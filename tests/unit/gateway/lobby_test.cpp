// Who has to go when there is no room for another.
#include "client/gateway/lobby.h"

#include <gtest/gtest.h>

#include <memory>

namespace wobble::gateway {
namespace {

// Guests by their number, in the order in which they come; each notes its number when it has to go.
class LobbyTest : public testing::Test {
 protected:
  Lobby::Guest& Come(const std::string& address) {
    const int number = static_cast<int>(guests.size());
    guests.push_back(std::make_unique<Lobby::Guest>());
    Lobby::Guest& guest = *guests.back();
    guest.address = address;
    guest.end = [this, number, &guest] {
      gone.push_back(number);
      lobby.Leave(guest);  // as connections do when they end
    };
    lobby.Enter(guest, now);
    return guest;
  }

  double now = 0;
  std::vector<std::unique_ptr<Lobby::Guest>> guests;
  std::vector<int> gone;
  Lobby lobby{5, 2};
};
using Numbers = std::vector<int>;

TEST_F(LobbyTest, AnAddressWithItsShareMakesRoomItself) {
  for (const char* address : {"a", "b", "a", "a", "a"}) Come(address);
  EXPECT_EQ(gone, (Numbers{0, 2}));
  EXPECT_EQ(lobby.Count(), 3U);
  EXPECT_EQ(lobby.CountEnded(), 2U);
}

TEST_F(LobbyTest, WhoHasWaitedLongestGoesWhereItIsFull) {
  for (const char* address : {"a", "b", "c", "d", "e", "f", "g"}) Come(address);
  EXPECT_EQ(gone, (Numbers{0, 1}));
  EXPECT_EQ(lobby.Count(), 5U);
}

TEST_F(LobbyTest, WhoIsAnsweredGoesOnlyWhenNoneWaits) {
  for (const char* address : {"a", "b", "c", "d", "e"}) Come(address);
  lobby.SetWaiting(*guests[0], false, 1);
  lobby.SetWaiting(*guests[1], true, 2);  // waits anew
  for (const char* address : {"f", "g"}) Come(address);
  EXPECT_EQ(gone, (Numbers{2, 3}));
  for (std::size_t i : {1, 4, 5, 6}) lobby.SetWaiting(*guests[i], false, 3);
  Come("h");
  EXPECT_EQ(gone, (Numbers{2, 3, 0}));
}

TEST_F(LobbyTest, WhoHasLeftMakesRoom) {
  for (const char* address : {"a", "b", "c", "d", "e"}) Come(address);
  lobby.Leave(*guests[3]);
  lobby.Leave(*guests[3]);
  Come("f");
  EXPECT_EQ(gone, Numbers{});
}

TEST_F(LobbyTest, AProxyHasMoreThanAnAddress) {
  for (int i = 0; i < 6; ++i) Come("");
  EXPECT_EQ(gone, Numbers{0});
}

TEST_F(LobbyTest, EndsTheOldestAlone) {
  for (const char* address : {"a", "b"}) {
    Come(address);
    now += 1;
  }
  lobby.EndOldest(0);
  EXPECT_EQ(gone, Numbers{}) << "none waits since before 0";
  lobby.EndOldest(1.5);
  EXPECT_EQ(gone, Numbers{0});
  lobby.EndOldest(1.5);
  EXPECT_EQ(gone, (Numbers{0, 1}));
  lobby.EndOldest(1.5);
  EXPECT_EQ(lobby.Count(), 0U);
}

}  // namespace
}  // namespace wobble::gateway
