// Every byte of the server query, as Valve's developer wiki lists them.
#include "protocol/server_query.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>

namespace wobble::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes FromText(const std::string& text) { return {text.begin(), text.end()}; }
Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const Bytes kHead{0xFF, 0xFF, 0xFF, 0xFF};
const Bytes kInfoQuery = kHead + FromText(std::string("TSource Engine Query\0", 21));

ServerPicture MakePicture() {
  return {.name = "Ada's",
          .scene = "arena",
          .version = "0.1",
          .port = 7777,
          .players = 3,
          .maxPlayers = 64,
          .isPrivate = true,
          .named = {{.name = "Zoë", .score = 258, .seconds = 1.5}},
          .rules = {{"key", "00ff"}}};
}

TEST(ServerQuery, ReadsTheThreeQueriesWithAndWithoutAChallenge) {
  const auto info = ReadQuery(kInfoQuery);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->kind, QueryKind::kInfo);
  EXPECT_FALSE(info->challenge);
  const Bytes challenge{0x78, 0x56, 0x34, 0x12};
  EXPECT_EQ(ReadQuery(kInfoQuery + challenge)->challenge, 0x12345678U);
  EXPECT_FALSE(ReadQuery(kInfoQuery + Bytes{0x78, 0x56, 0x34})->challenge);
  const auto players = ReadQuery(kHead + Bytes{'U'} + challenge);
  ASSERT_TRUE(players);
  EXPECT_EQ(players->kind, QueryKind::kPlayers);
  EXPECT_EQ(players->challenge, 0x12345678U);
  EXPECT_EQ(ReadQuery(kHead + Bytes{'V'} + kHead)->challenge, 0xFFFFFFFFU);
  for (const Query& query : {*info, *players, Query{QueryKind::kRules, 7}, Query{QueryKind::kInfo, 9}}) {
    const auto again = ReadQuery(MakeQuery(query));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->kind, query.kind);
    EXPECT_EQ(again->challenge, query.challenge);
  }
  EXPECT_EQ(MakeQuery(*info), kInfoQuery);
}

// A challenge of nine bytes is never more than was asked with.
TEST(ServerQuery, RefusesWhatIsNoQueryOrShorterThanAChallenge) {
  EXPECT_FALSE(ReadQuery({}));
  EXPECT_FALSE(ReadQuery(kHead));
  EXPECT_FALSE(ReadQuery(kHead + Bytes{'U'}));
  EXPECT_FALSE(ReadQuery(kHead + Bytes{'U', 1, 2, 3}));
  EXPECT_FALSE(ReadQuery(kHead + Bytes{'V'}));
  EXPECT_FALSE(ReadQuery(kHead + Bytes{'W', 1, 2, 3, 4}));
  EXPECT_FALSE(ReadQuery(kHead + Bytes{'i'}));
  EXPECT_FALSE(ReadQuery(Bytes(kInfoQuery.begin(), kInfoQuery.end() - 1)));
  Bytes wrong = kInfoQuery;
  wrong[8] ^= 1U;
  EXPECT_FALSE(ReadQuery(wrong));
  wrong = kInfoQuery;
  wrong[0] = 0xFE;
  EXPECT_FALSE(ReadQuery(wrong));
  std::mt19937 random(1);
  Bytes challenge;
  WriteChallenge(1, challenge);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = i % 2 == 0 ? kInfoQuery : kHead + Bytes{static_cast<std::uint8_t>(random())};
    bytes.resize(random() % 40);
    if (!bytes.empty()) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    const bool isQuery = ReadQuery(bytes).has_value();
    EXPECT_TRUE(!isQuery || bytes.size() >= challenge.size());
    static_cast<void>(ReadInfo(bytes));
    static_cast<void>(ReadChallenge(bytes));
  }
}

TEST(ServerQuery, WritesAChallenge) {
  Bytes datagram{1, 2, 3};
  WriteChallenge(0x12345678, datagram);
  EXPECT_EQ(datagram, kHead + (Bytes{'A', 0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(ReadChallenge(datagram), 0x12345678U);
  datagram.pop_back();
  EXPECT_FALSE(ReadChallenge(datagram));
}

TEST(ServerQuery, TellsWhatIsPlayed) {
  const auto answer = MakeAnswer(QueryKind::kInfo, MakePicture(), 1);
  ASSERT_EQ(answer.size(), 1U);
  const Bytes expected = kHead + Bytes{'I', 17} +
                         FromText(std::string("Ada's\0arena\0wobble\0wobble: soft bodies\0", 39)) +
                         Bytes{0, 0, 3, 64, 0, 'd', 'l', 1, 0} + FromText(std::string("0.1\0", 4)) +
                         Bytes{0xA0, 0x61, 0x1E} + FromText(std::string("wobble\0", 7));
  EXPECT_EQ(answer.front(), expected);
  const auto read = ReadInfo(answer.front());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, "Ada's");
  EXPECT_EQ(read->scene, "arena");
  EXPECT_EQ(read->version, "0.1");
  EXPECT_EQ(read->port, 7777);
  EXPECT_EQ(read->players, 3U);
  EXPECT_EQ(read->maxPlayers, 64U);
  EXPECT_TRUE(read->isPrivate);
  // Where the extra fields begin, an answer may end.
  const std::size_t needed = expected.size() - 10;
  for (std::size_t size = 0; size < expected.size(); ++size) {
    EXPECT_EQ(ReadInfo(std::span(expected).first(size)).has_value(), size >= needed) << size;
  }
}

TEST(ServerQuery, TellsWhoPlaysAndTheRules) {
  const auto players = MakeAnswer(QueryKind::kPlayers, MakePicture(), 1);
  ASSERT_EQ(players.size(), 1U);
  const Bytes zoe{'D', 1, 0, 'Z', 'o', 0xC3, 0xAB, 0, 2, 1, 0, 0, 0, 0, 0xC0, 0x3F};
  EXPECT_EQ(players.front(), kHead + zoe);
  const auto rules = MakeAnswer(QueryKind::kRules, MakePicture(), 1);
  ASSERT_EQ(rules.size(), 1U);
  const Bytes key = Bytes{'E', 1, 0} + FromText("key") + Bytes{0} + FromText("00ff") + Bytes{0};
  EXPECT_EQ(rules.front(), kHead + key);
}

TEST(ServerQuery, CountsUpTo255AndCutsLongAnswersIntoParts) {
  ServerPicture picture = MakePicture();
  picture.players = picture.maxPlayers = 4000;
  const auto info = ReadInfo(MakeAnswer(QueryKind::kInfo, picture, 1).front());
  EXPECT_EQ(info->players, 255U);
  EXPECT_EQ(info->maxPlayers, 255U);
  picture.named.clear();
  for (int i = 0; i < 4000; ++i) picture.named.push_back({.name = std::string(32, static_cast<char>('a' + i % 26))});
  const auto parts = MakeAnswer(QueryKind::kPlayers, picture, 0x80000007);
  ASSERT_EQ(parts.size(), 8U);
  Bytes whole;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_LE(parts[i].size(), kMaxQueryBytes);
    const Bytes head{0xFE, 0xFF, 0xFF, 0xFF, 7, 0, 0, 0, 8, static_cast<std::uint8_t>(i), 0x78, 0x05};
    EXPECT_EQ(Bytes(parts[i].begin(), parts[i].begin() + 12), head);
    whole.insert(whole.end(), parts[i].begin() + 12, parts[i].end());
  }
  ASSERT_EQ(whole.size(), 6U + 255U * 42U);
  const Bytes begin = kHead + Bytes{'D', 255, 0, 'a'};
  EXPECT_EQ(Bytes(whole.begin(), whole.begin() + 8), begin);
}

}  // namespace
}  // namespace wobble::protocol
