// What strangers learn who ask what is played, and that asking in another's name sends that one nothing.
#include <algorithm>
#include <thread>

#include "protocol/server_query.h"
#include "tests/unit/vestibule/door_fixture.h"

namespace wobble::transport::vestibule {
namespace {

using protocol::Query;
using protocol::QueryKind;
using protocol::ServerPicture;

class QueriesTest : public DoorTest {
 protected:
  QueriesTest() {
    OpenWithPictures();
    Show({.name = "Ada's", .players = 2});
  }
  void OpenWithPictures() {
    Door::Settings settings;
    settings.pictures = slot;
    Open(std::move(settings));
  }
  void Show(const ServerPicture& picture) { slot->Put(std::make_unique<const ServerPicture>(picture)); }
  std::vector<Bytes> Ask(const Bytes& query, const NetAddress& from = kHome) {
    const Door::Result result = m_door->TakeDatagram(from, query, now);
    EXPECT_EQ(result.visitor, 0U);
    EXPECT_TRUE(result.plain.empty());
    EXPECT_TRUE(result.answer.empty());
    return {result.told.begin(), result.told.end()};
  }
  std::uint32_t AskForChallenge(const NetAddress& from = kHome) {
    const auto answer = Ask(protocol::MakeQuery({}), from);
    if (answer.size() != 1) return 0;
    return protocol::ReadChallenge(answer.front()).value_or(0);
  }
  std::optional<ServerPicture> AskForInfo(std::uint32_t challenge, const NetAddress& from = kHome) {
    const auto answer = Ask(protocol::MakeQuery({QueryKind::kInfo, challenge}), from);
    return answer.size() == 1 ? protocol::ReadInfo(answer.front()) : std::nullopt;
  }
  [[nodiscard]] std::uint64_t Count(QueryAnswer answer) const {
    return m_door->Counts().queries[static_cast<std::size_t>(answer)];
  }

  std::shared_ptr<PictureSlot> slot = std::make_shared<PictureSlot>();
};

TEST_F(QueriesTest, AreAnsweredToWhoShowsTheChallenge) {
  const std::uint32_t challenge = AskForChallenge();
  const auto info = AskForInfo(challenge);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->name, "Ada's");
  EXPECT_EQ(Ask(protocol::MakeQuery({QueryKind::kPlayers, challenge})).front()[4], 'D');
  EXPECT_EQ(Ask(protocol::MakeQuery({QueryKind::kRules, challenge})).front()[4], 'E');
  Show({.name = "Ada's", .players = 9});
  EXPECT_EQ(AskForInfo(challenge)->players, 9U);
  EXPECT_EQ(Count(QueryAnswer::kChallenge), 1U);
  EXPECT_EQ(Count(QueryAnswer::kInfo), 2U);
  EXPECT_EQ(Count(QueryAnswer::kPlayers), 1U);
  EXPECT_EQ(Count(QueryAnswer::kRules), 1U);
}

TEST_F(QueriesTest, OfAnotherAddressPortOrTimeAreAnsweredByAChallenge) {
  const std::uint32_t challenge = AskForChallenge();
  EXPECT_FALSE(AskForInfo(challenge, MakeAddress(192, 0, 2, 2, 5000)));
  EXPECT_FALSE(AskForInfo(challenge, MakeAddress(192, 0, 2, 1, 5001)));
  EXPECT_FALSE(AskForInfo(challenge ^ 1U));
  now += 9.9;
  EXPECT_TRUE(AskForInfo(challenge));
  now += 10.2;
  EXPECT_FALSE(AskForInfo(challenge));
  EXPECT_EQ(Count(QueryAnswer::kInfo), 1U);
}

TEST_F(QueriesTest, InAnothersNameSendThatOneNoMoreThanWasAsked) {
  std::mt19937 random(1);
  std::size_t in = 0, out = 0, answered = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto third = static_cast<std::uint8_t>(random());
    const auto kind = std::array{QueryKind::kInfo, QueryKind::kPlayers, QueryKind::kRules}[random() % 3];
    Bytes query = protocol::MakeQuery({kind, static_cast<std::uint32_t>(random())});
    if (i % 4 == 0) query.resize(random() % 40);
    in += query.size();
    std::size_t answer = 0;
    for (const Bytes& each : Ask(query, MakeAddress(10, 0, third, 1, 53))) answer += each.size();
    EXPECT_LE(answer, query.size());
    out += answer;
    answered += answer > 0 ? 1U : 0U;
    now += 1e-4;
  }
  EXPECT_LT(out, in);
  EXPECT_GT(answered, 1000U);
  EXPECT_EQ(m_door->CountVisitors(), 0U);
}

TEST_F(QueriesTest, HaveTheRateOfOtherStrangers) {
  const std::uint32_t challenge = AskForChallenge();
  int answers = 0;
  for (int i = 0; i < 1000; ++i) answers += AskForInfo(challenge) ? 1 : 0;
  EXPECT_GE(answers, 100);
  EXPECT_LE(answers, 200);
  Caller caller = MakeCaller();
  Bytes request;
  caller.FindDue(now, request);
  EXPECT_TRUE(Knock(kHome, request).answer.empty()) << "they share it with requests";
  now += 1;
  EXPECT_TRUE(AskForInfo(challenge));
}

// An answer in parts costs the subnet as many askings.
TEST_F(QueriesTest, OfManyNamesAreAnsweredLessOften) {
  ServerPicture picture;
  for (int i = 0; i < 255; ++i) picture.named.push_back({.name = std::string(32, 'a')});
  Show(picture);
  const std::uint32_t challenge = AskForChallenge();
  std::size_t datagrams = 0;
  for (int i = 0; i < 1000; ++i) datagrams += Ask(protocol::MakeQuery({QueryKind::kPlayers, challenge})).size();
  EXPECT_GE(datagrams, 100U);
  EXPECT_LE(datagrams, 200U);
}

TEST_F(QueriesTest, AreNotAnsweredBeforeTheFirstPictureNorWhereNothingIsTold) {
  slot = std::make_shared<PictureSlot>();
  OpenWithPictures();
  EXPECT_TRUE(Ask(protocol::MakeQuery({})).empty());
  Open();
  EXPECT_TRUE(Ask(protocol::MakeQuery({})).empty());
  EXPECT_EQ(m_door->Counts().invalid, 1U);
}

TEST(PictureSlot, HandsOverTheNewestFromOneThreadToAnother) {
  PictureSlot slot;
  EXPECT_EQ(slot.Take(), nullptr);
  constexpr std::size_t kLast = 20'000;
  std::thread ticks([&slot] {
    for (std::size_t i = 1; i <= kLast; ++i) {
      slot.Put(std::make_unique<const ServerPicture>(ServerPicture{.name = std::to_string(i), .players = i}));
    }
  });
  std::size_t newest = 0;
  while (newest < kLast) {
    const auto picture = slot.Take();
    if (picture == nullptr) continue;
    EXPECT_GT(picture->players, newest);
    EXPECT_EQ(picture->name, std::to_string(picture->players));
    newest = picture->players;
  }
  ticks.join();
  EXPECT_EQ(slot.Take(), nullptr);
}

}  // namespace
}  // namespace wobble::transport::vestibule
