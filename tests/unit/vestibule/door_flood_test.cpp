// What the door hears of many datagrams, from its own players, injected or by strangers, and what it answers.
#include <random>

#include "tests/unit/vestibule/door_fixture.h"

namespace wobble::transport::vestibule {
namespace {

// 100,000 datagrams that were injected, altered or recorded, from the player's own address.
TEST_F(DoorTest, AcceptsNothingThatTheClientDidNotSend) {
  Open();
  Caller caller = MakeCaller();
  static_cast<void>(Enter(caller));
  std::vector<Bytes> recorded{response};
  std::mt19937 random(4);
  std::uint64_t accepted = 0, sent = 0;
  const auto attack = [&](const Bytes& datagram) {
    const Taken taken = Knock(kHome, datagram);
    accepted += taken.plain.empty() && !taken.isNew && !taken.isOffence ? 0 : 1;
    ++sent;
  };
  std::uint16_t number = 0;
  while (sent < 100'000) {
    now += 0.01;
    const Bytes genuine = Seal(caller, MakeReliable(++number, 40), now);
    Bytes invented(random() % 100);
    for (std::uint8_t& byte : invented) byte = static_cast<std::uint8_t>(random());
    if (!invented.empty()) invented[0] = 0x10;
    for (std::size_t i = 1; i < 4 && invented.size() > 4; ++i) invented[i] = genuine[i];  // the right session
    attack(invented);
    for (int i = 0; i < 8; ++i) {
      Bytes altered = genuine;
      altered[random() % altered.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      attack(altered);
    }
    ASSERT_EQ(Knock(kHome, genuine).plain, MakeReliable(number, 40));
    recorded.push_back(genuine);
    for (int i = 0; i < 4; ++i) attack(recorded[random() % recorded.size()]);
    attack(Bytes(genuine.begin(), genuine.end() - 1));
  }
  EXPECT_EQ(accepted, 0U);
  EXPECT_EQ(caller.ReadState(), Caller::State::kIn);
}

TEST_F(DoorTest, WhoSendsWhatNoHonestClientSendsIsHeardNoMore) {
  Door& door = Open();
  Caller caller = MakeCaller();
  static_cast<void>(Enter(caller));
  Bytes fragment = MakeReliable(1, 20);
  fragment[6] = 0x88;
  EXPECT_TRUE(Knock(kHome, Seal(caller, fragment, now)).isOffence);
  const Taken after = Knock(kHome, Seal(caller, MakeReliable(1, 20), now));
  EXPECT_TRUE(after.plain.empty());
  EXPECT_FALSE(after.isOffence) << "told once";
  EXPECT_EQ(door.Counts().offences, 1U);
}

TEST_F(DoorTest, AVisitorMaySendSoManyDatagramsASecond) {
  Open();
  Caller caller = MakeCaller();
  static_cast<void>(Enter(caller));
  int passed = 0;
  for (int i = 0; i < 20'000; ++i) {  // in two seconds
    now += 1e-4;
    passed += Knock(kHome, Seal(caller, MakeReliable(1, 20), now)).plain.empty() ? 0 : 1;
  }
  EXPECT_GE(passed, 2 * 200) << "what an honest client may need";
  EXPECT_LE(passed, 2 * 400 + 800);
}

TEST_F(DoorTest, OneSubnetCannotTakeAllHandshakes) {
  Open();
  int taken = 0;
  for (int i = 0; i < 150; ++i) {
    Caller caller = MakeCaller();
    taken +=
        Enter(caller, MakeAddress(10, 0, 0, static_cast<std::uint8_t>(i % 7), static_cast<std::uint16_t>(1000 + i)))
                .isNew
            ? 1
            : 0;
    m_door->Remove(static_cast<VisitorId>(taken));
  }
  EXPECT_LE(taken, 101);
  EXPECT_NE(EnterAnew(MakeAddress(10, 0, 1, 1, 1)), 0U) << "its neighbour is let in";
  now += 1;
  EXPECT_NE(EnterAnew(MakeAddress(10, 0, 0, 1, 1)), 0U) << "a second later it, too";
}

TEST_F(DoorTest, AFloodOfManySubnetsIsAnsweredScarcelyAndKeepsNobodyOut) {
  Open();
  Bytes request;
  Write(Request{.client = MakeKeyPair(MakeRandom(3)).publicKey}, request);
  std::size_t answers = 0;
  for (int i = 0; i < 100'000; ++i, now += 2e-5) {
    const auto third = static_cast<std::uint8_t>(i % 250);
    answers += Knock(MakeAddress(198, 51, third, 7, 4000), request).answer.empty() ? 0U : 1U;
  }
  // In 2 s, of all together 4,000 and 2,000 a second; of each of 250 subnets 20 and 5 a second.
  EXPECT_LE(answers, 8000U + 7500U + 10U);
  EXPECT_GT(answers, 10'000U);
  Caller caller = MakeCaller();
  EXPECT_NE(Enter(caller).visitor, 0U);
}

}  // namespace
}  // namespace wobble::transport::vestibule
