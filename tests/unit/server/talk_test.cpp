// What players tell one another, on the virtual network: lines, emotes, names, and those who may tell nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/play/playground.h"
#include "tests/support/game.h"
#include "tests/unit/server/ear.h"

namespace wobble::server {
namespace {

using protocol::wire::EmoteKind;
using protocol::wire::EventKind;
using protocol::wire::GoodbyeReason;
using protocol::wire::Role;
using test::Ear;
using test::Game;
using testing::ElementsAre;
using testing::HasSubstr;
using transport::Channel;

// A client with what it hears.
struct Person {
  Person(Game& game, const std::string& name, bool isSpectator = false)
      : client(game.AddClient({.name = name, .spectator = isSpectator})), ear(client) {
    client.OnNotice([this](const std::string& line) { notices.push_back(line); });
    game.Run(0.5);
    EXPECT_EQ(client.ReadState(), client::State::kPlaying);
  }
  ~Person() {  // the client outlives it
    client.OnEvent({});
    client.OnNotice({});
  }
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  [[nodiscard]] std::vector<std::string> Heard(EventKind kind = EventKind::Said) const {
    std::vector<std::string> lines;
    for (const auto& event : ear.events) {
      if (event.kind == kind) lines.push_back(event.name);
    }
    return lines;
  }

  client::Client& client;
  Ear ear;
  std::vector<std::string> notices;
};

TEST(Talk, ALineReachesEverybodyAsOneCleanLine) {
  Game game(test::MakeYard());
  Person ada(game, "Ada"), bob(game, "Bob"), eve(game, "Eve", true);
  EXPECT_EQ(ada.client.Welcome().talk, protocol::kMaySay | protocol::kMayEmote);
  EXPECT_EQ(eve.client.Welcome().talk, 0);
  ada.client.Say("  hello,\tBob\xe2\x80\xae ");
  ada.client.Say(" \xe2\x80\x8b ");
  game.Run(0.5);
  EXPECT_THAT(ada.Heard(), ElementsAre("hello, Bob"));
  EXPECT_THAT(bob.Heard(), ElementsAre("hello, Bob"));
  EXPECT_THAT(eve.Heard(), ElementsAre("hello, Bob"));
  ASSERT_FALSE(bob.ear.events.empty());
  EXPECT_EQ(bob.ear.events.back().clientId, ada.client.Welcome().clientId);
  EXPECT_EQ(bob.ear.events.back().body, ada.client.Welcome().ownBody);
  EXPECT_THAT(ada.notices, ElementsAre(HasSubstr("there is nothing in it")));
  EXPECT_TRUE(bob.notices.empty());
  EXPECT_EQ(game.server.ReadCounts().said, 1U);
  EXPECT_EQ(game.server.ReadCounts().talkRefused, 1U);
}

TEST(Talk, BytesThatAreNoTextAndLinesThatAreTooLong) {
  Game game(test::MakeYard());
  Person ada(game, "Ada");
  test::RawConnection& raw = game.AddRaw();
  game.Run(0.2);
  raw.Send(Channel::kControl, protocol::MakeHello("raw", Role::Player));
  game.Run(0.5);
  raw.Send(Channel::kControl, protocol::MakeSay("a\xff\xfe\x01 b"));
  raw.Send(Channel::kControl, protocol::MakeRename(std::string("\xc0\x80\0x", 4)));
  raw.Send(Channel::kControl, protocol::MakeSay(std::string(protocol::kMaxSaidBytes, 'x')));
  raw.Send(Channel::kControl, protocol::MakeSay(std::string(protocol::kMaxSaidBytes + 1, 'y')));
  game.Run(0.5);
  EXPECT_THAT(ada.Heard(), ElementsAre("a\xef\xbf\xbd\xef\xbf\xbd b", std::string(protocol::kMaxSaidBytes, 'x')));
  EXPECT_THAT(ada.Heard(EventKind::Rename), ElementsAre("\xef\xbf\xbd\xef\xbf\xbd x"));
  EXPECT_EQ(game.server.ReadCounts().dropped[static_cast<std::size_t>(DropReason::kParse)], 1U);
  EXPECT_TRUE(raw.Connected());
}

TEST(Talk, FourAtOnceAndOneASecondAndToldOnce) {
  Game game(test::MakeYard());
  Person ada(game, "Ada"), bob(game, "Bob");
  for (int i = 0; i < 4; ++i) ada.client.Say(std::to_string(i));
  for (int i = 0; i < 6; ++i) ada.client.Emote(EmoteKind::Laugh);
  game.Run(0.3);
  EXPECT_THAT(bob.Heard(), ElementsAre("0", "1", "2", "3"));
  EXPECT_TRUE(bob.Heard(EventKind::Emote).empty());
  EXPECT_THAT(ada.notices, ElementsAre(HasSubstr("too fast"))) << "once";
  game.Run(1);
  ada.client.Say("4");
  ada.client.Say("5");
  game.Run(0.3);
  EXPECT_THAT(bob.Heard(), ElementsAre("0", "1", "2", "3", "4"));
  EXPECT_EQ(ada.notices.size(), 2U) << "once more, since it was heard meanwhile";
}

TEST(Talk, WhoFloodsIsSentAwayAndOthersAreHeard) {
  Game game(test::MakeYard());
  Person ada(game, "Ada"), bob(game, "Bob"), mal(game, "Mal");
  for (int i = 0; i < 60 * 5; ++i) {
    for (int k = 0; k < 10; ++k) mal.client.Say("buy " + std::string(180, 'x'));
    if (i % 90 == 0) bob.client.Say("bob " + std::to_string(i));
    game.Step();
  }
  EXPECT_EQ(mal.client.ReadState(), client::State::kEnded);
  EXPECT_THAT(mal.client.EndReason(), HasSubstr("too much"));
  const auto heard = ada.Heard();
  EXPECT_EQ(std::ranges::count_if(heard, [](const auto& line) { return line.starts_with("bob"); }), 4);
  EXPECT_LE(std::ranges::count_if(heard, [](const auto& line) { return line.starts_with("buy"); }), 8);
  EXPECT_EQ(game.server.ReadCounts().goodbyes[static_cast<std::size_t>(GoodbyeReason::TooMuch)], 1U);
  EXPECT_LE(mal.notices.size(), 6U) << "told when it changes, not each time";
}

TEST(Talk, ACrowdTogetherSaysNoMoreThanTwentyLinesASecond) {
  Game game(test::MakeYard());
  Person ada(game, "Ada");
  std::vector<client::Client*> crowd;
  for (int i = 0; i < 15; ++i) crowd.push_back(&game.AddClient({.name = "one of them"}));
  game.Run(1);
  for (client::Client* each : crowd) {
    for (int i = 0; i < 4; ++i) each->Say("all at once");
  }
  game.Run(0.05);
  EXPECT_GE(ada.Heard().size(), 20U);
  EXPECT_LE(ada.Heard().size(), 22U);
  EXPECT_EQ(game.server.ReadCounts().said + game.server.ReadCounts().talkRefused, 60U);
}

TEST(Talk, WatchersReadAndModeratorsAmongThemMaySay) {
  Game game(test::MakeYard());
  Person ada(game, "Ada"), eve(game, "Eve", true);
  eve.client.Say("boo");
  eve.client.Emote(EmoteKind::Wave);
  game.Run(0.3);
  EXPECT_TRUE(ada.Heard().empty());
  EXPECT_THAT(eve.notices, ElementsAre(HasSubstr("reads lines"), HasSubstr("no body")));
  ASSERT_TRUE(game.server.SetRank(eve.client.Welcome().clientId, transport::Rank::kModerator));
  eve.client.Say("be nice");
  game.Run(0.3);
  EXPECT_THAT(ada.Heard(), ElementsAre("be nice"));
}

TEST(Talk, WithoutChatEmotesStay) {
  Game game(test::MakeYard(), {.forbidsChat = true});
  Person ada(game, "Ada"), bob(game, "Bob");
  EXPECT_EQ(ada.client.Welcome().talk, protocol::kMayEmote);
  ada.client.Say("hello");
  ada.client.Emote(EmoteKind::Cheer);
  game.Run(0.3);
  EXPECT_TRUE(bob.Heard().empty());
  EXPECT_THAT(ada.notices, ElementsAre(HasSubstr("switched that off")));
  EXPECT_EQ(bob.Heard(EventKind::Emote).size(), 1U);
  EXPECT_EQ(bob.ear.events.back().emote, EmoteKind::Cheer);
  EXPECT_EQ(bob.ear.events.back().body, ada.client.Welcome().ownBody);
}

TEST(Talk, AMutedOneIsToldAndTellsNothingUntilTheTimeIsOver) {
  Game game(test::MakeYard());
  Person ada(game, "Ada"), bob(game, "Bob");
  ASSERT_TRUE(game.server.Mute(ada.client.Welcome().clientId, game.now + 2));
  ada.client.Say("hello");
  ada.client.Emote(EmoteKind::Sad);
  ada.client.Rename("Eve");
  game.Run(1);
  EXPECT_TRUE(bob.Heard().empty());
  EXPECT_TRUE(bob.Heard(EventKind::Emote).empty());
  EXPECT_TRUE(bob.Heard(EventKind::Rename).empty());
  EXPECT_THAT(ada.notices, ElementsAre(HasSubstr("muted"), HasSubstr("muted"))) << "at the mute, and at the first try";
  EXPECT_NEAR(game.server.ListPlayers(game.now).at(0).mutedFor, 1, 0.1);
  game.Run(1.2);
  EXPECT_EQ(ada.notices.size(), 3U);
  ada.client.Say("hello");
  game.Run(0.3);
  EXPECT_THAT(bob.Heard(), ElementsAre("hello"));
  EXPECT_EQ(game.server.ReadCounts().talkRefused, 3U);
}

TEST(Talk, AMutedOneWhoComesBackIsMutedStill) {
  Game game(test::MakeYard());
  for (const bool hasAccount : {false, true}) {
    game.admission = {};
    if (hasAccount) game.admission.account = 7;
    if (!hasAccount) game.admission.identity[3] = 9;
    const auto first = std::make_unique<Person>(game, "Ada");
    ASSERT_TRUE(game.server.Mute(first->client.Welcome().clientId));
    first->client.Leave(game.now);
    game.Run(0.5);
    Person again(game, "Ada");
    EXPECT_TRUE(game.server.ListPlayers(game.now).back().isMuted);
    EXPECT_THAT(again.notices, ElementsAre(HasSubstr("muted")));
    ASSERT_TRUE(game.server.Unmute(again.client.Welcome().clientId));
    again.client.Leave(game.now);
    game.Run(0.5);
    Person last(game, "Ada");
    EXPECT_FALSE(game.server.ListPlayers(game.now).back().isMuted);
  }
  game.admission = {};
  Person stranger(game, "Eve");
  EXPECT_FALSE(game.server.ListPlayers(game.now).back().isMuted);
}

TEST(Talk, ANewNameIsFreeAndOverTheBodyAndKept) {
  Game game(test::MakeYard());
  Person ada(game, "Ada"), bob(game, "Bob");
  const std::uint32_t client = bob.client.Welcome().clientId;
  bob.client.Rename(
      "\xd0\x90"
      "da");  // a Cyrillic A
  game.Run(0.3);
  EXPECT_THAT(ada.Heard(EventKind::Rename), ElementsAre("\xd0\x90"
                                                        "da 2"));
  EXPECT_EQ(ada.ear.events.back().clientId, client);
  EXPECT_EQ(ada.ear.events.back().body, bob.client.Welcome().ownBody);
  EXPECT_EQ(game.server.ListPlayers(game.now).at(1).name,
            "\xd0\x90"
            "da 2");
  EXPECT_TRUE(game.HasBody(bob.client.Welcome().ownBody)) << "it has not left";
  bob.client.Rename("Bo");
  bob.client.Rename("Bert");
  game.Run(0.3);
  EXPECT_THAT(bob.notices, ElementsAre(HasSubstr("as before"))) << "two at once, then one in five seconds";
  EXPECT_EQ(game.server.ListPlayers(game.now).at(1).name, "Bo");
  ada.client.Rename("Ada");
  game.Run(0.3);
  EXPECT_EQ(game.server.ReadCounts().renames, 2U);
  Person late(game, "Cy");
  EXPECT_THAT(late.Heard(EventKind::Join), testing::Contains("Bo"));
}

TEST(Talk, ATokensNameStays) {
  Game game(test::MakeYard());
  game.admission.name = {'A', 'd', 'a'};
  Person ada(game, "whatever");
  ada.client.Rename("Bob");
  game.Run(0.3);
  EXPECT_EQ(game.server.ListPlayers(game.now).at(0).name, "Ada");
  EXPECT_THAT(ada.notices, ElementsAre(HasSubstr("token")));
}

TEST(Talk, ANewNameIsPartOfWhatIsPlayed) {
  Playground playground(test::MakeYard(), {});
  playground.Take(JoinEntry{1, false, "Ada"});
  const auto body = playground.FindPlayer(1)->body;
  playground.Take(JoinEntry{1, false, "Bob"});
  EXPECT_EQ(playground.FindPlayer(1)->name, "Bob");
  EXPECT_EQ(playground.FindPlayer(1)->body, body);
  EXPECT_EQ(playground.Players().size(), 1U);
}

TEST(Talk, TheSceneSaysWhatItIs) {
  Game game(test::MakeYard("\n"));
  Person ada(game, "Ada");
  EXPECT_EQ(ada.client.Welcome().description, "");
  Game other(test::LoadShippedScene("pair"));
  Person bob(other, "Bob");
  EXPECT_EQ(bob.client.Welcome().description, test::LoadShippedScene("pair").description);
  EXPECT_FALSE(bob.client.Welcome().description.empty());
}

}  // namespace
}  // namespace wobble::server
