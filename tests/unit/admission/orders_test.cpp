// Orders, from the line that is given to what players see of it.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "server/admin/orders.h"
#include "server/recording/film.h"
#include "tests/support/game.h"
#include "tests/unit/recording/matches.h"
#include "tests/unit/vestibule/deterministic.h"

namespace wobble::admin {
namespace {

using test::Game;
using transport::Rank;

class OrdersTest : public testing::Test {
 protected:
  void Start(const std::string& tables = "") {
    EXPECT_TRUE(transport::vestibule::InitialiseSodium());
    game = std::make_unique<Game>(test::MakeYard(tables));
    admission::GateSettings settings;
    settings.readUnixTime = [] { return std::uint64_t{1'800'000'000}; };
    settings.random = transport::vestibule::MakeRandom(1);
    gate = std::make_unique<admission::Gate>(settings, admission::Bans{}, admission::Invites{});
    game->server.SetOrderTaker([this](server::ClientId client, Rank rank, const std::string& line) {
      return CarryOut({game->server, *gate}, {.rank = rank, .client = client}, line, game->now).lines;
    });
  }
  Answer Give(const std::string& line, const Issuer& issuer = {}) {
    return CarryOut({game->server, *gate}, issuer, line, game->now);
  }
  client::Client& Join(const std::string& name) {
    client::Client& client = game->AddClient({.name = name});
    game->Run(0.5);
    EXPECT_EQ(client.ReadState(), client::State::kPlaying);
    return client;
  }

  std::unique_ptr<Game> game;
  std::unique_ptr<admission::Gate> gate;
};

TEST_F(OrdersTest, KickAndBanSayWhy) {
  Start();
  client::Client& ada = Join("Ada");
  client::Client& bob = Join("Bob");
  EXPECT_NE(Give("players").lines.at(0).find("Ada"), std::string::npos);
  EXPECT_TRUE(Give("kick 1 be nice").isDone);
  EXPECT_FALSE(Give("kick 1").isDone) << "gone already";
  EXPECT_FALSE(Give("ban 2").isDone) << "neither account nor address on the virtual network";
  EXPECT_TRUE(Give("ban 192.0.2.7 for 2h floods").isDone);
  EXPECT_FALSE(Give("ban 192.0.2.8 for 2y").isDone);
  EXPECT_EQ(Give("bans").lines.size(), 1U);
  EXPECT_TRUE(Give("unban 1").isDone);
  EXPECT_FALSE(Give("unban 1").isDone);
  game->Run(0.5);
  EXPECT_EQ(ada.ReadState(), client::State::kEnded);
  EXPECT_NE(ada.EndReason().find("be nice"), std::string::npos) << ada.EndReason();
  EXPECT_EQ(bob.ReadState(), client::State::kPlaying);
}

TEST_F(OrdersTest, RanksBoundWhatPlayersMayOrder) {
  Start();
  client::Client& ada = Join("Ada");
  client::Client& bob = Join("Bob");
  std::vector<std::string> notices;
  ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
  ada.Order("kick 2");
  game->Run(0.5);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("moderator"), std::string::npos) << notices[0];
  EXPECT_TRUE(Give("rank 1 moderator").isDone);
  EXPECT_TRUE(Give("rank 2 moderator").isDone);
  ada.Order("kick 2");
  ada.Order("rank 1 owner");
  ada.Order("invite moderator");
  game->Run(0.5);
  EXPECT_EQ(notices.size(), 4U);
  EXPECT_EQ(bob.ReadState(), client::State::kPlaying) << "moderators do not put each other out";
  EXPECT_TRUE(Give("rank 2 player").isDone);
  ada.Order("kick 2");
  game->Run(0.5);
  EXPECT_EQ(bob.ReadState(), client::State::kEnded);
  EXPECT_TRUE(Give("hand-over 1").isDone);
  ada.Order("rank 1 owner");
  game->Run(0.5);
  EXPECT_EQ(Give("players").lines.size(), 1U);
  EXPECT_NE(Give("players").lines[0].find("owner"), std::string::npos);
}

TEST_F(OrdersTest, LockKeepsOutAndMuteKeepsStill) {
  Start("[hands]\npush = true\n[tuning]\ngravity = \"everyone\"\n");
  client::Client& ada = Join("Ada");
  std::vector<std::string> notices;
  ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
  EXPECT_TRUE(Give("mute 1").isDone);
  ada.Tune(protocol::wire::TuneKind::Gravity, {0, 0, 1});
  game->Run(0.5);
  ASSERT_EQ(notices.size(), 2U) << "at the mute, and at the try";
  EXPECT_EQ(game->server.World().Settings().gravity.z(), -9.81);
  EXPECT_EQ(Give("mute 1 for 15m").lines.at(0), "Ada may only move, for 900 s");
  EXPECT_NE(Give("players").lines.at(0).find("muted for 900 s"), std::string::npos);
  EXPECT_NE(Give("status").lines.at(0).find(", 1 muted"), std::string::npos);
  EXPECT_TRUE(Give("unmute 1").isDone);
  ada.Tune(protocol::wire::TuneKind::Gravity, {0, 0, 1});
  game->Run(0.5);
  EXPECT_EQ(game->server.World().Settings().gravity.z(), 1);
  EXPECT_TRUE(Give("reset").isDone);
  EXPECT_EQ(game->server.World().Settings().gravity.z(), -9.81);

  EXPECT_TRUE(Give("lock").isDone);
  client::Client& late = game->AddClient();
  game->Run(0.5);
  EXPECT_EQ(late.ReadState(), client::State::kEnded);
  EXPECT_EQ(late.EndReason(), "the server is locked, its host lets nobody in at present");
  EXPECT_TRUE(Give("unlock").isDone);
  Join("Eve");
}

TEST_F(OrdersTest, PlayersWaitBetweenJumpsAndOwnersDoNot) {
  Start("[tuning]\ntime = \"everyone\"\n");
  client::Client& ada = Join("Ada");
  std::vector<std::string> notices;
  ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
  ada.Tune(protocol::wire::TuneKind::Jump, {2, 0, 0});
  ada.Tune(protocol::wire::TuneKind::Jump, {2, 0, 0});
  game->Run(0.5);
  EXPECT_EQ(notices.size(), 1U);
  game->Run(6);
  ada.Tune(protocol::wire::TuneKind::Jump, {2, 0, 0});
  game->Run(0.5);
  EXPECT_EQ(notices.size(), 1U);
  EXPECT_TRUE(Give("rank 1 owner").isDone);
  ada.Tune(protocol::wire::TuneKind::Jump, {2, 0, 0});
  game->Run(0.5);
  EXPECT_EQ(notices.size(), 1U);
}

TEST_F(OrdersTest, InvitesAreMadeListedAndRevoked) {
  Start();
  const Answer made = Give("invite watcher for 7d uses 3");
  ASSERT_EQ(made.lines.size(), 3U);
  EXPECT_EQ(made.lines[1].rfind("#invite=", 0), 0U);
  EXPECT_NE(made.lines[2].find("--invites"), std::string::npos) << "it does not outlive the server";
  EXPECT_NE(Give("invites").lines.at(0).find("3 uses left"), std::string::npos);
  EXPECT_TRUE(Give("revoke 1").isDone);
  EXPECT_EQ(Give("invites").lines.at(0), "nobody is invited");
  EXPECT_FALSE(Give("invite king").isDone);
  EXPECT_FALSE(Give("invite for never").isDone);
  EXPECT_FALSE(Give("invite uses 0").isDone);
}

TEST_F(OrdersTest, WordsComeInAnyOrderAndNoneIsDropped) {
  Start();
  const std::string ends = Give("invite uses 3 for 1h").lines.at(0);
  EXPECT_NE(ends.find("until 2027-01-15 09:00 UTC, 3 uses left"), std::string::npos) << ends;
  EXPECT_EQ(Give("invite for 1h moderator uses 3").lines.at(0).substr(16), ends.substr(16));
  Join("Ada");
  for (const auto& [order, words] :
       {std::pair{"mute 1 please", "please"}, std::pair{"mute 1 for ages", "ages"},
        std::pair{"mute 1 for 1h now", "now"}, std::pair{"lock now", "now"}, std::pair{"rank 1 owner please", "please"},
        std::pair{"invite player for 1h for 2h", "for"}, std::pair{"invite uses 3 times", "times"},
        std::pair{"invite player watcher", "watcher"}, std::pair{"revoke 1 2", "2"}, std::pair{"unban 1 2", "2"},
        std::pair{"protect on all", "all"}}) {
    const Answer answer = Give(order);
    EXPECT_FALSE(answer.isDone) << order;
    EXPECT_NE(answer.lines.at(0).find(words), std::string::npos) << order << ": " << answer.lines.at(0);
  }
  EXPECT_FALSE(game->server.IsLocked());
  EXPECT_FALSE(game->server.ListPlayers(game->now).at(0).isMuted);
  EXPECT_EQ(Give("invites").lines.size(), 2U) << "the refused ones were not made";
  EXPECT_FALSE(Give("say " + std::string(200, 'a')).isDone) << "rather than half of it";
}

TEST_F(OrdersTest, BansAreNamedByWhomTheyKeepOut) {
  Start();
  for (const char* whom : {"10.0.0.0/8", "999.1.1.1", "host.example", "account:x"}) {
    const Answer answer = Give(std::string("ban ") + whom);
    EXPECT_FALSE(answer.isDone);
    EXPECT_NE(answer.lines.at(0).find("neither a player's number"), std::string::npos) << answer.lines.at(0);
    EXPECT_NE(answer.lines.at(0).find(whom), std::string::npos) << answer.lines.at(0);
  }
  EXPECT_NE(Give("ban 7").lines.at(0).find("no player has the number 7"), std::string::npos);
  EXPECT_NE(Give("unban").lines.at(0).find("name a ban"), std::string::npos);
  EXPECT_NE(Give("revoke").lines.at(0).find("name an invite"), std::string::npos);
  EXPECT_NE(Give("").lines.at(0).find("an order is missing"), std::string::npos);

  EXPECT_TRUE(Give("ban 192.0.2.7 for 2h floods").isDone);
  EXPECT_TRUE(Give("ban 192.0.2.7 floods again for 4h").isDone);
  EXPECT_TRUE(Give("ban 2001:db8:1:2::3").isDone);
  EXPECT_TRUE(Give("ban account:7 for ever").isDone);
  const std::vector<std::string> bans = Give("bans").lines;
  ASSERT_EQ(bans.size(), 3U) << "the second of an address takes the place of the first";
  EXPECT_NE(bans[0].find("12:00 UTC, floods again"), std::string::npos) << bans[0];
  EXPECT_FALSE(Give("unban 192.0.2.8").isDone);
  EXPECT_FALSE(Give("unban 192.0.2.0/24").isDone);
  EXPECT_TRUE(Give("unban 192.0.2.7").isDone);
  EXPECT_TRUE(Give("unban 2001:db8:1:2::4").isDone) << "of the same /64";
  EXPECT_TRUE(Give("unban account:7").isDone);
  EXPECT_EQ(Give("bans").lines.at(0), "nobody is banned");
}

TEST_F(OrdersTest, WhoIsBannedReadsUntilWhenAndWhy) {
  Start();
  game->admission = {.from = transport::ParseIp("192.0.2.7").value()};
  client::Client& ada = Join("Ada");
  ASSERT_TRUE(Give("ban 1 for 2h cuts everything").isDone);
  game->Run(0.5);
  EXPECT_NE(ada.EndReason().find("until 2027-01-15 10:00 UTC, cuts everything"), std::string::npos) << ada.EndReason();
}

// Bots of this machine, and browsers behind a gateway without a key, have one address between them.
TEST_F(OrdersTest, WhoComesFromThisMachineIsBannedByAddressOnly) {
  Start();
  for (const char* address : {"127.0.0.1", "127.9.9.9", "::1"}) {
    game->admission = {.from = transport::ParseIp(address).value()};
    Join("Ada");
    const std::string number = std::to_string(game->server.ListPlayers(game->now).back().client);
    const Answer answer = Give("ban " + number);
    EXPECT_FALSE(answer.isDone);
    EXPECT_NE(answer.lines.at(0).find(std::string("ban ") + address), std::string::npos) << answer.lines.at(0);
    EXPECT_TRUE(Give(std::string("ban ") + address).isDone);
  }
}

TEST_F(OrdersTest, ARevokedInviteTakesItsRankAlong) {
  Start();
  ASSERT_TRUE(Give("invite moderator").isDone);
  ASSERT_TRUE(Give("invite watcher").isDone);
  game->admission = {.rank = Rank::kModerator, .invite = 1};
  client::Client& ada = Join("Ada");
  Join("Bob");
  game->admission = {.rank = Rank::kWatcher, .invite = 2};
  Join("Cy");
  game->admission = {.rank = Rank::kModerator};
  Join("Dan");  // by a token
  EXPECT_TRUE(Give("rank 2 owner").isDone) << "appointed, apart from its invite";
  std::vector<std::string> notices;
  ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
  const Answer refused = Give("revoke 1", {.rank = Rank::kModerator, .client = 4});
  EXPECT_FALSE(refused.isDone) << "moderators do not demote their equals";
  const Answer revoked = Give("revoke 1");
  ASSERT_TRUE(revoked.isDone);
  EXPECT_EQ(revoked.lines.at(1), "1 of those who are in is a player now");
  game->Run(0.5);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("invite"), std::string::npos) << notices[0];
  ada.Order("kick 3");
  game->Run(0.5);
  ASSERT_EQ(notices.size(), 2U);
  EXPECT_NE(notices[1].find("you are player"), std::string::npos) << notices[1];
  EXPECT_TRUE(Give("revoke 2", {.rank = Rank::kModerator, .client = 4}).isDone);
  const std::vector<server::Server::Player> players = game->server.ListPlayers(game->now);
  ASSERT_EQ(players.size(), 4U);
  const std::array kRanks{Rank::kPlayer, Rank::kOwner, Rank::kWatcher, Rank::kModerator};
  for (std::size_t i = 0; i < kRanks.size(); ++i) EXPECT_EQ(players[i].admission.rank, kRanks[i]) << players[i].name;
}

// The lines that a client is told.
struct Notices {
  explicit Notices(client::Client& client) {
    client.OnNotice([this](const std::string& line) { lines.push_back(line); });
  }
  // Whether the newest has these words.
  [[nodiscard]] bool Ends(const std::string& words) const {
    return !lines.empty() && lines.back().find(words) != std::string::npos;
  }
  std::vector<std::string> lines;
};

constexpr std::uint32_t kBall = 1;  // of the yard; it falls from 1 m

TEST_F(OrdersTest, ModeratorsLetTheWorldBeginAnew) {
  Start("[tuning]\ngravity = \"everyone\"\n");
  client::Client& ada = Join("Ada");
  game->Run(1);
  const Notices notices(ada);
  ada.Order("restart");
  game->Run(0.2);
  EXPECT_TRUE(notices.Ends("is for moderators"));
  EXPECT_LT(game->Centre(kBall).z(), 0.9);
  EXPECT_TRUE(Give("rank 1 moderator").isDone);
  ada.Tune(protocol::wire::TuneKind::Gravity, {0, 0, 0});
  game->Run(0.2);
  ada.Order("restart");
  game->Run(0.1);
  EXPECT_TRUE(notices.Ends("begins anew"));
  EXPECT_GT(game->Centre(kBall).z(), 0.9);
  EXPECT_EQ(game->server.World().Settings().gravity.z(), -9.81);
  EXPECT_TRUE(Give("restart").isDone) << "from outside as well";
  EXPECT_FALSE(Give("restart now").isDone);
}

TEST_F(OrdersTest, MoreThanHalfOfThePlayersVoteForANewWorld) {
  Start();
  client::Client& ada = Join("Ada");
  client::Client& bob = Join("Bob");
  Join("Cy");
  client::Client& dan = Join("Dan");
  client::Client& eve = game->AddClient({.name = "Eve", .spectator = true});
  game->Run(1);
  const Notices adas(ada);
  const Notices dans(dan);
  const Notices eves(eve);
  EXPECT_TRUE(Give("mute 4").isDone);
  const auto vote = [&](client::Client& client) {
    client.Order("vote restart");
    game->Run(0.1);
  };
  vote(ada);
  EXPECT_TRUE(adas.Ends("Ada votes to begin anew: 1 of 3; 2 are enough")) << adas.lines.back();
  EXPECT_TRUE(eves.Ends("Ada votes to begin anew: 1 of 3")) << "everybody is told";
  EXPECT_EQ(adas.lines.size(), 1U) << "and told once";
  vote(ada);
  EXPECT_TRUE(adas.Ends("voted already"));
  vote(dan);
  EXPECT_TRUE(dans.Ends("has no vote")) << "muted";
  vote(eve);
  EXPECT_TRUE(eves.Ends("has no vote")) << "watches";
  EXPECT_LT(game->Centre(kBall).z(), 0.9);
  vote(bob);
  EXPECT_GT(game->Centre(kBall).z(), 0.9);
  EXPECT_TRUE(adas.Ends("2 of 3 have voted to begin anew: the world begins anew")) << adas.lines.back();
  vote(bob);
  game->Run(2);
  EXPECT_LT(game->Centre(kBall).z(), 0.9) << "one vote passes a minute";
}

TEST_F(OrdersTest, PlayersSayThatTheyAreReady) {
  Start("[game]\nkind = \"sumo\"\nlobby = 60\n");
  client::Client& ada = Join("Ada");
  client::Client& bob = Join("Bob");
  client::Client& eve = game->AddClient({.name = "Eve", .spectator = true});
  game->AddClient({.name = "bot 1", .isBot = true});
  game->Run(1);
  const Notices adas(ada);
  const Notices eves(eve);
  const auto order = [&](client::Client& client, const char* line) {
    client.Order(line);
    game->Run(0.2);
  };
  using protocol::wire::GamePhase;
  EXPECT_EQ(ada.ReadScoreboard().phase, GamePhase::Lobby);
  ASSERT_EQ(ada.ReadScoreboard().seats.size(), 3U);
  EXPECT_TRUE(ada.ReadScoreboard().seats[2].bot() && ada.ReadScoreboard().seats[2].ready());
  order(ada, "ready");
  EXPECT_TRUE(adas.Ends("you are ready: 2 of 3 are ready")) << "a bot is at once";
  order(ada, "ready no");
  EXPECT_TRUE(adas.Ends("you are not ready: 1 of 3"));
  order(ada, "ready soon");
  EXPECT_TRUE(adas.Ends("ready: may be followed by no"));
  order(eve, "ready");
  EXPECT_TRUE(eves.Ends("you watch"));
  EXPECT_TRUE(Give("mute 1").isDone);
  order(ada, "ready");
  order(bob, "ready");
  EXPECT_EQ(ada.ReadScoreboard().phase, GamePhase::Playing);
  order(ada, "ready");
  EXPECT_TRUE(adas.Ends("the match has begun already"));
  EXPECT_FALSE(Give("ready").isDone) << "who is outside does not play";
  Start();
  const Notices bobs(Join("Bob"));
  game->clients.back()->Order("ready");
  game->Run(0.2);
  EXPECT_TRUE(bobs.Ends("there is no game to be ready for"));
}

TEST_F(OrdersTest, ScenesFollowOneAnotherByOrderAndByVote) {
  Start();
  EXPECT_FALSE(Give("next").isDone) << "there is no other";
  EXPECT_FALSE(Give("vote next", {.rank = Rank::kPlayer, .client = 1}).isDone);
  EXPECT_EQ(Give("scene").lines.front(), "yard");
  scenes::Scene other = test::MakeYard();
  other.name = "other";
  game->server.Rotate(
      {{.scene = test::MakeYard(), .source = {}, .bases = {}}, {.scene = std::move(other), .source = {}, .bases = {}}});
  client::Client& ada = Join("Ada");
  const Notices notices(ada);
  EXPECT_EQ(Give("scene").lines.front(), "yard of yard, other");
  EXPECT_FALSE(Give("scene moon").isDone);
  EXPECT_FALSE(Give("next please").isDone);
  EXPECT_TRUE(Give("scene other").isDone);
  game->Run(1);
  EXPECT_EQ(game->server.SceneName(), "other");
  EXPECT_TRUE(Give("next").isDone);
  game->Run(1);
  EXPECT_EQ(game->server.SceneName(), "yard");
  ada.Order("next");
  game->Run(1);
  EXPECT_TRUE(notices.Ends("is for moderators"));
  ada.Order("vote next");
  game->Run(1);
  EXPECT_EQ(game->server.SceneName(), "other") << "who is alone decides";
}

TEST_F(OrdersTest, AVoteEndsWithItsMinuteAndWithItsOpponents) {
  Start();
  client::Client& ada = Join("Ada");
  client::Client& bob = Join("Bob");
  const Notices notices(ada);
  ada.Order("vote restart");
  game->Run(59);
  EXPECT_EQ(notices.lines.size(), 1U);
  game->Run(2);
  EXPECT_TRUE(notices.Ends("1 of 2 have voted to begin anew: too few"));
  ada.Order("vote restart");
  game->Run(1);
  EXPECT_LT(game->Centre(kBall).z(), 0.9);
  bob.Leave(game->now);
  game->Run(0.1);
  EXPECT_GT(game->Centre(kBall).z(), 0.9) << "1 of 1";
  EXPECT_TRUE(notices.Ends("the world begins anew"));
  game->Run(61);
  ada.Order("vote restart");
  game->Run(0.1);
  EXPECT_GT(game->Centre(kBall).z(), 0.9) << "who is alone restarts at once";
  EXPECT_FALSE(Give("vote restart").isDone) << "who is outside does not play";
  EXPECT_FALSE(Give("vote", {.rank = Rank::kPlayer, .client = 1}).isDone);
  EXPECT_FALSE(Give("vote kick 1", {.rank = Rank::kPlayer, .client = 1}).isDone);
  EXPECT_FALSE(Give("vote restart", {.rank = Rank::kWatcher, .client = 1}).isDone);
}

TEST_F(OrdersTest, ARecordingIsWoundAndNotPlayed) {
  Start();
  const recording::Folder folder;
  recording::RecordMatch("pair", 130, recording::MakeSettings(folder));
  game = std::make_unique<Game>(test::LoadShippedScene("pair"));
  recording::Recording match;
  ASSERT_EQ(match.Open(folder.List()[0]), "");
  ASSERT_EQ(game->server.Show(std::make_unique<recording::Film>(folder.List()[0], std::move(match))), "");
  for (const char* line : {"reset", "restart", "next", "scene", "scene pair", "vote restart", "protect on"}) {
    const Answer answer = Give(line);
    EXPECT_FALSE(answer.isDone) << line;
    EXPECT_NE(answer.lines.at(0).find(": a recording is shown; film to 0 begins it anew"), std::string::npos) << line;
  }
  const std::vector<std::pair<const char*, const char*>> answers{
      {"film to 1", "plays 0:01.0 of 0:02.2, speed 1, tick 60"},
      {"film step -2", "paused at 0:01.0 of 0:02.2, speed 1, tick 58"},
      {"film by 9", "paused at 0:02.2 of 0:02.2, speed 1, tick 130"},
      {"film step 1.5", "film step 1.5: must be a whole number from -1000000 to 1000000"},
      {"film to", "film to: must be a number from -1000000 to 1000000"},
      {"film speed 17", "film speed 17: must be a number from -4 to 16"}};
  for (const auto& [line, answer] : answers) EXPECT_EQ(Give(line).lines.at(0), answer) << line;
}

TEST_F(OrdersTest, AnyLineIsAnswered) {
  Start();
  const std::string lines[] = {"",
                               " ",
                               "kick",
                               "kick x",
                               "kick 99999999999999999999",
                               "ban",
                               "ban account:0",
                               "rank 1",
                               "help",
                               "say \x1b[31m",
                               "mute",
                               "protect",
                               "protect maybe",
                               "vote",
                               "vote \x1b[31m",
                               "unban",
                               std::string(5000, 'a'),
                               std::string("kick\0 1", 7),
                               "revoke -1",
                               "invite player for",
                               "hand-over"};
  for (const std::string& line : lines) {
    const Answer answer = Give(line);
    EXPECT_FALSE(answer.lines.empty()) << line;
    for (const std::string& each : answer.lines) {
      EXPECT_EQ(each.find_first_of("\x1b\n"), std::string::npos) << line;
      EXPECT_LE(each.size(), 300U);
    }
  }
  EXPECT_EQ(ParseSpan("90s"), 90U);
  EXPECT_EQ(ParseSpan("7d"), 7U * 24 * 3600);
  EXPECT_EQ(ParseSpan("ever"), 0U);
  for (const char* bad : {"", "s", "0s", "-1s", "1", "1y", "99999999999999999999d", "4000d"})
    EXPECT_FALSE(ParseSpan(bad)) << bad;
}

constexpr const char* kProtectedWorkshop = R"(
[[blueprint]]
name = "frame"
kind = "graph"
particle = [{ position = [0, 0, 0], fixed = true }, { position = [1, 0, 0] }]
spring = [{ ends = [0, 1], stiffness = 500 }]
[[bodies]]
blueprint = "frame"
position = [0, 0, 2]
[workshop]
blueprint = "frame"
protected = true
)";

TEST_F(OrdersTest, WhatOthersBuiltIsProtectedAndTheWorkshopIsReset) {
  using protocol::wire::BuildKind;
  Start(kProtectedWorkshop);
  client::Client& ada = Join("Ada");
  std::vector<std::string> notices;
  ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
  const auto countParticles = [&] {
    const auto& body = game->server.World().ReadBody(ada.Welcome().workshop);
    return game->server.World().BlueprintOf(body).rest.size();
  };
  const auto build = [&](const protocol::BuildFields& fields) {
    ada.Build(fields);
    game->Run(0.5);
  };
  build({.kind = BuildKind::RemoveParticle, .a = 2});
  EXPECT_EQ(notices.size(), 1U) << "it is the scene's";
  EXPECT_EQ(countParticles(), 2U);
  build({.kind = BuildKind::AddParticle, .at = {-2, -1, 1.5F}, .mass = 0.5F, .fixed = true});
  EXPECT_EQ(countParticles(), 3U);
  EXPECT_TRUE(Give("protect off").isDone);
  build({.kind = BuildKind::RemoveParticle, .a = 2});
  EXPECT_EQ(countParticles(), 2U);
  EXPECT_TRUE(Give("protect on").isDone);
  build({.kind = BuildKind::AddParticle, .at = {-2, -1, 1.5F}, .mass = 0.5F, .fixed = true});
  ada.Order("vote restart");
  game->Run(0.5);
  ASSERT_EQ(notices.size(), 2U);
  EXPECT_NE(notices[1].find("is protected"), std::string::npos) << notices[1];
  EXPECT_EQ(countParticles(), 3U) << "a vote is no way round it";
  EXPECT_TRUE(Give("reset").isDone);
  game->Run(0.5);
  EXPECT_EQ(countParticles(), 2U);
  const auto& body = game->server.World().ReadBody(ada.Welcome().workshop);
  std::vector<physics::Vector3d> places;
  physics::VisitVertices(body, [&](std::size_t, const physics::Vector3d& x) { places.push_back(x); });
  EXPECT_NEAR(places.at(0).z(), 2, 0.05) << "where the scene has it";
  EXPECT_NEAR((places.at(1) - places.at(0)).norm(), 1, 0.1);
}

}  // namespace
}  // namespace wobble::admin
