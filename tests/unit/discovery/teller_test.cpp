// What a world tells strangers of itself.
#include "server/discovery/teller.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/game.h"

namespace wobble::discovery {
namespace {

const Identity kIdentity{.version = "1.2.3", .port = 7777, .key = "00ff", .maxClients = 8};

struct Told : testing::Test {
  Told() {
    game.AddClient({.name = "Ada"});
    game.AddClient({.name = "Eve", .spectator = true});
    game.Run(1);
  }
  [[nodiscard]] protocol::ServerPicture Tell(const Identity& identity = kIdentity) const {
    return MakePicture(game.server, identity, game.now);
  }
  test::Game game{test::MakeYard()};
};

TEST_F(Told, ThePictureHasWhatIsPlayedAndByWhom) {
  const protocol::ServerPicture picture = Tell();
  EXPECT_EQ(picture.name, "yard") << "the scene's";
  EXPECT_EQ(picture.scene, "yard");
  EXPECT_EQ(picture.version, "1.2.3");
  EXPECT_EQ(picture.port, 7777);
  EXPECT_EQ(picture.players, 2U);
  EXPECT_EQ(picture.maxPlayers, 8U);
  EXPECT_FALSE(picture.isPrivate);
  ASSERT_EQ(picture.named.size(), 2U);
  EXPECT_EQ(picture.named[0].name, "Ada");
  EXPECT_NEAR(picture.named[0].seconds, 1, 0.3);
  const std::pair<std::string, std::string> key{"key", "00ff"};
  EXPECT_NE(std::find(picture.rules.begin(), picture.rules.end(), key), picture.rules.end());
  Identity named = kIdentity;
  named.name = "Ada's world";
  EXPECT_EQ(Tell(named).name, "Ada's world");
}

TEST_F(Told, WhereNotEverybodyMayComeInNobodyIsNamed) {
  Identity closed = kIdentity;
  closed.wantsCredential = true;
  EXPECT_TRUE(Tell(closed).named.empty());
  EXPECT_EQ(Tell(closed).players, 2U);
  EXPECT_TRUE(Tell(closed).isPrivate);
  game.server.SetLocked(true);
  EXPECT_TRUE(Tell().named.empty());
  EXPECT_TRUE(Tell().isPrivate);
}

TEST_F(Told, ANewPictureComesOnceASecond) {
  const auto slot = std::make_shared<transport::vestibule::PictureSlot>();
  const auto other = std::make_shared<transport::vestibule::PictureSlot>();
  Teller teller(kIdentity, {slot, other});
  teller.Update(game.server, 1);
  EXPECT_NE(slot->Take(), nullptr);
  EXPECT_NE(other->Take(), nullptr);
  teller.Update(game.server, 1.9);
  EXPECT_EQ(slot->Take(), nullptr);
  teller.Update(game.server, 2.1);
  EXPECT_NE(slot->Take(), nullptr);
}

TEST(ServerName, HasAtMost63BytesAndNoControlCharacters) {
  EXPECT_EQ(FindFault(""), "");
  EXPECT_EQ(FindFault("Zoë's world"), "");
  EXPECT_EQ(FindFault(std::string(63, 'a')), "");
  EXPECT_NE(FindFault(std::string(64, 'a')), "");
  EXPECT_NE(FindFault("two\nlines"), "");
  EXPECT_NE(FindFault("\xFF"), "");
}

}  // namespace
}  // namespace wobble::discovery
