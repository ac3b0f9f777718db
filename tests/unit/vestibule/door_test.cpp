// Who gets in at the door, who learns why not, and who has to leave.
#include <algorithm>
#include <map>
#include <random>

#include "tests/unit/vestibule/door_fixture.h"

namespace wobble::transport::vestibule {
namespace {

TEST_F(DoorTest, LetsInWithTwoDatagramsAndPassesTheFirstOfEnet) {
  Door& door = Open();
  Caller caller = MakeCaller();
  const Taken taken = Enter(caller);
  EXPECT_EQ(taken.visitor, 1U);
  EXPECT_TRUE(taken.isNew);
  EXPECT_EQ(taken.plain, MakeConnect(9));
  EXPECT_EQ(caller.ReadState(), Caller::State::kIn);
  EXPECT_EQ(caller.ServerKey(), door.ServerKey());
  EXPECT_EQ(door.CountVisitors(), 1U);

  const Taken next = Knock(kHome, Seal(caller, MakeReliable(1, 30), now));
  EXPECT_EQ(next.plain, MakeReliable(1, 30));
  EXPECT_EQ(next.visitor, 1U);
  EXPECT_FALSE(next.isNew);

  const Door::Leg leg = door.FindLeg(1);
  EXPECT_EQ(leg.address, kHome);
  Sealer sealer(leg.toClient);
  const Bytes words{1, 2, 3};
  const std::span<const std::uint8_t> part = words;
  Bytes datagram;
  sealer.Seal(SealedKind::kData, leg.session, {&part, 1}, datagram);
  const auto plain = caller.TakeDatagram(datagram, now);
  EXPECT_EQ(Bytes(plain.begin(), plain.end()), words);
  EXPECT_TRUE(caller.TakeDatagram(datagram, now).empty()) << "again";
}

// Anybody can send requests in anybody's name.
TEST_F(DoorTest, BeforeAnAddressIsProvedTheDoorSendsLessThanItGetsAndRemembersNothing) {
  Door& door = Open();
  std::mt19937 random(1);
  std::size_t in = 0, out = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto a = static_cast<std::uint8_t>(random()), b = static_cast<std::uint8_t>(random());
    const NetAddress victim = MakeAddress(a, b, static_cast<std::uint8_t>(random()), 1, 53);
    Caller forger = MakeCaller();
    Bytes request;
    forger.FindDue(now, request);
    if (i % 3 == 1) request.resize(random() % request.size());
    if (i % 3 == 2) request.resize(1232);
    in += request.size();
    const Taken taken = Knock(victim, request);
    EXPECT_LE(taken.answer.size(), request.size());
    out += taken.answer.size();
    EXPECT_EQ(taken.visitor, 0U);
    EXPECT_TRUE(taken.plain.empty());
    now += 1e-4;
  }
  EXPECT_LT(out, in / 2);
  EXPECT_EQ(door.CountVisitors(), 0U);
  // A response with a cookie for another address or port, of another key, or with any bit changed.
  Caller caller = MakeCaller();
  Ask(caller);
  const Bytes good = Seal(caller, MakeConnect(1), now);
  EXPECT_EQ(Knock(MakeAddress(192, 0, 2, 2, 5000), good).visitor, 0U);
  EXPECT_EQ(Knock(MakeAddress(192, 0, 2, 1, 5001), good).visitor, 0U);
  for (std::size_t bit = 8; bit < 8 * (2 + 16 + 32); ++bit) {
    Bytes changed = good;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    const Taken taken = Knock(kHome, changed);
    EXPECT_EQ(taken.visitor, 0U) << "bit " << bit;
    EXPECT_TRUE(taken.answer.empty());
  }
  EXPECT_EQ(door.CountVisitors(), 0U);
  EXPECT_EQ(Knock(kHome, good).visitor, 1U);
}

TEST_F(DoorTest, CookiesGrowOld) {
  Open();
  for (const auto& [age, isGood] : std::map<double, bool>{{9.9, true}, {19.9, true}, {20.1, false}, {2600, false}}) {
    now = 1000 * (2 + std::floor(age));  // the beginning of an epoch
    Caller caller = MakeCaller();
    Ask(caller);
    const Bytes datagram = Seal(caller, MakeConnect(1), now);
    now += age;
    EXPECT_EQ(Knock(kHome, datagram).isNew, isGood) << age;
  }
}

// A response comes again while its answer is lost, or because somebody recorded it.
TEST_F(DoorTest, AResponseOpensOneSessionOnly) {
  Door& door = Open();
  Caller caller = MakeCaller();
  const Taken first = Enter(caller);
  const Taken again = Knock(kHome, response);
  EXPECT_FALSE(again.isNew);
  EXPECT_TRUE(again.plain.empty()) << "its datagram has passed";
  door.Remove(first.visitor);
  EXPECT_EQ(door.CountVisitors(), 0U);
  EXPECT_EQ(Knock(kHome, response).visitor, 0U) << "or its keys would come back with their numbers from 1";
  now += 19;
  EXPECT_EQ(Knock(kHome, response).visitor, 0U);
  now += 100;
  EXPECT_EQ(Knock(kHome, response).visitor, 0U);
  EXPECT_EQ(door.Counts().accepted, 1U);
}

TEST_F(DoorTest, AnAnswerThatWasLostComesAgain) {
  Open();
  Caller caller = MakeCaller();
  Ask(caller);
  static_cast<void>(Knock(kHome, Seal(caller, MakeConnect(3), now)));
  EXPECT_EQ(caller.ReadState(), Caller::State::kResponding);
  now += 0.3;
  Bytes again;
  caller.FindDue(now, again);
  const Taken taken = Knock(kHome, again);
  EXPECT_EQ(taken.visitor, 1U);
  EXPECT_EQ(taken.plain, MakeConnect(3)) << "sealed anew";
  static_cast<void>(caller.TakeDatagram(taken.answer, now));
  EXPECT_EQ(caller.ReadState(), Caller::State::kIn);
}

// Lets in whoever has the word.
struct WordJudge : Judge {
  explicit WordJudge(Bytes right) : word(std::move(right)) {}
  [[nodiscard]] bool WantsCredential() const override { return true; }
  [[nodiscard]] NetAddress FindSource(Credential&, const NetAddress& from) override { return from; }
  [[nodiscard]] Judgement Decide(const Credential& credential, const NetAddress&) override {
    ++judged;
    return {.refusal = credential.bytes == word ? Refusal::kNone : Refusal::kBadCredential};
  }
  Bytes word;
  int judged = 0;
};

TEST_F(DoorTest, SaysWhyNot) {
  Door::Settings settings;
  settings.maxVisitors = 3;
  settings.maxPerAddress = 2;
  settings.judge = std::make_shared<WordJudge>(Bytes{'o', 'k'});
  Door& door = Open(settings);
  const auto enter = [&](std::uint8_t host, const char* word) {
    Caller caller = MakeCaller({.credential = {Credential::Kind::kPassword, {word, word + 2}}});
    static_cast<void>(Enter(caller, MakeAddress(10, 0, 0, host, 1)));
    EXPECT_TRUE(caller.WantsCredential());
    return caller.ReadRefusal();
  };
  EXPECT_EQ(enter(1, "no"), Refusal::kBadCredential);
  EXPECT_EQ(enter(1, "ok"), Refusal::kNone);
  EXPECT_EQ(enter(1, "ok"), Refusal::kNone);
  EXPECT_EQ(enter(1, "ok"), Refusal::kTooManyFromAddress);
  EXPECT_EQ(enter(2, "ok"), Refusal::kNone);
  EXPECT_EQ(enter(3, "ok"), Refusal::kFull);
  door.Release(1);
  EXPECT_EQ(enter(1, "ok"), Refusal::kNone) << "the seat of one who is being sent away is free";
  EXPECT_EQ(enter(3, "ok"), Refusal::kFull);
  EXPECT_EQ(door.CountVisitors(), 4U);
  EXPECT_EQ(door.Counts().refused, 4U);
  const auto count = [&](Turnaway why) { return door.Counts().turnaways[static_cast<std::size_t>(why)].count; };
  EXPECT_EQ(count(Turnaway::kPassword), 1U);
  EXPECT_EQ(count(Turnaway::kTooManyFromAddress), 1U);
  EXPECT_EQ(count(Turnaway::kFull), 2U);
  EXPECT_EQ(door.Counts().turnaways[static_cast<std::size_t>(Turnaway::kFull)].last, MakeAddress(10, 0, 0, 3, 1));
}

// A server's own user shows an owner's key by itself; where it does not fit, nobody has asked for it.
TEST_F(DoorTest, AKeyThatWasNotAskedForIsNotShownTwice) {
  class OpenJudge final : public Judge {
   public:
    [[nodiscard]] bool WantsCredential() const override { return false; }
    [[nodiscard]] NetAddress FindSource(Credential&, const NetAddress& from) override { return from; }
    [[nodiscard]] Judgement Decide(const Credential& credential, const NetAddress&) override {
      shown.push_back(credential.kind);
      return {.refusal = credential.kind == Credential::Kind::kNone ? Refusal::kNone : Refusal::kBadCredential};
    }
    std::vector<Credential::Kind> shown;
  };
  Door::Settings settings;
  const auto judge = std::make_shared<OpenJudge>();
  settings.judge = judge;
  Open(settings);
  Caller caller = MakeCaller({.ownServer = m_door->ServerKey(), .ownCredential = {Credential::Kind::kOwnerKey, {1}}});
  EXPECT_FALSE(Enter(caller).isNew);
  EXPECT_EQ(caller.ReadState(), Caller::State::kRequesting);
  Ask(caller);
  Bytes again;
  caller.FindDue(now, again);
  const Taken taken = Knock(kHome, again);
  EXPECT_TRUE(taken.isNew);
  EXPECT_EQ(taken.plain, MakeConnect(9)) << "what ENet had sent before";
  static_cast<void>(caller.TakeDatagram(taken.answer, now));
  EXPECT_EQ(caller.ReadState(), Caller::State::kIn);
  EXPECT_EQ(judge->shown, (std::vector{Credential::Kind::kOwnerKey, Credential::Kind::kNone}));

  Caller insists = MakeCaller({.credential = {Credential::Kind::kOwnerKey, {1}}});
  static_cast<void>(Enter(insists, MakeAddress(192, 0, 2, 2, 5000)));
  EXPECT_EQ(insists.ReadState(), Caller::State::kRefused) << "what somebody gave is not left out";
}

// A password is guessed ten times, then once in five seconds; the right one is not heard meanwhile either.
TEST_F(DoorTest, ASubnetMayNotGuessForLong) {
  Door::Settings settings;
  const auto judge = std::make_shared<WordJudge>(Bytes{7});
  settings.judge = judge;
  Open(settings);
  const auto enter = [&](std::uint8_t guess, const NetAddress& from) {
    Caller caller = MakeCaller({.credential = {Credential::Kind::kPassword, {guess}}});
    static_cast<void>(Enter(caller, from));
    return caller.ReadRefusal();
  };
  const NetAddress here = MakeAddress(10, 0, 0, 1, 1), there = MakeAddress(10, 0, 1, 1, 1);
  for (int i = 0; i < 30; ++i) EXPECT_EQ(enter(7, here), Refusal::kNone) << "who knows it is never slowed down";
  judge->judged = 0;
  for (int i = 0; i < 40; ++i) EXPECT_EQ(enter(1, here), Refusal::kBadCredential);
  EXPECT_EQ(judge->judged, 10);
  EXPECT_EQ(enter(7, here), Refusal::kBadCredential);
  const DoorCounts counts = m_door->Counts();
  EXPECT_EQ(counts.turnaways[static_cast<std::size_t>(Turnaway::kPassword)].count, 10U);
  EXPECT_EQ(counts.turnaways[static_cast<std::size_t>(Turnaway::kTooManyGuesses)].count, 31U);
  EXPECT_EQ(enter(7, there), Refusal::kNone);
  now += 5.1;
  EXPECT_EQ(enter(7, here), Refusal::kNone);
}

TEST_F(DoorTest, TheCallerKnowsItsServer) {
  Open();
  Key other{};
  other[0] = 9;
  Caller misled = MakeCaller({.server = other});
  Ask(misled);
  EXPECT_EQ(misled.ReadState(), Caller::State::kWrongServer);
  Caller right = MakeCaller({.server = m_door->ServerKey()});
  EXPECT_TRUE(Enter(right).isNew);
  // Somebody on the way gives himself out as the server: he has its public key and not its secret one.
  Caller victim = MakeCaller({.server = m_door->ServerKey()});
  Bytes request;
  victim.FindDue(now, request);
  auto challenge = ReadChallenge(Knock(kHome, request).answer);
  ASSERT_TRUE(challenge);
  const KeyPair his = MakeKeyPair(MakeRandom(99));
  challenge->started = his.publicKey;
  Bytes forged;
  Write(*challenge, forged);
  static_cast<void>(victim.TakeDatagram(forged, now));
  const Bytes answer = Seal(victim, MakeConnect(1), now);
  EXPECT_EQ(Knock(kHome, answer).visitor, 0U);
  EXPECT_EQ(victim.ReadState(), Caller::State::kResponding);
}

TEST_F(DoorTest, AnotherVersionIsToldSo) {
  Open();
  Caller caller = MakeCaller();
  Bytes request;
  caller.FindDue(now, request);
  request[1] = kVestibuleVersion + 1;
  const Taken taken = Knock(kHome, request);
  static_cast<void>(caller.TakeDatagram(taken.answer, now));
  EXPECT_EQ(caller.ReadState(), Caller::State::kOtherVersion);
}

TEST_F(DoorTest, RemovesWhoNeverConnectsAndWhoIsSilent) {
  Door& door = Open();
  Caller mute = MakeCaller(), talker = MakeCaller();
  Ask(mute);
  const Bytes nothing = MakeReliable(1, 5);  // no CONNECT
  const Taken taken = Knock(kHome, Seal(mute, nothing, now));
  EXPECT_TRUE(taken.isNew);
  const NetAddress other = MakeAddress(10, 1, 1, 1, 1);
  static_cast<void>(Enter(talker, other));
  std::vector<VisitorId> removed;
  now += 4.9;
  door.RemoveOverdue(now, removed);
  EXPECT_TRUE(removed.empty());
  now += 0.2;
  door.RemoveOverdue(now, removed);
  EXPECT_EQ(removed, std::vector<VisitorId>{1});
  now += 20;
  static_cast<void>(Knock(other, Seal(talker, MakeReliable(1, 5), now)));
  now += 29;
  door.RemoveOverdue(now, removed);
  EXPECT_TRUE(removed.empty());
  now += 2;
  door.RemoveOverdue(now, removed);
  EXPECT_EQ(removed, std::vector<VisitorId>{2});
}

// Killed and started again with the same key: it knows nobody, and tells them in a way that nobody else can.
TEST_F(DoorTest, ARestartedServerTellsItsClientsOfBefore) {
  Open();
  Caller caller = MakeCaller();
  static_cast<void>(Enter(caller));
  Open();
  const Bytes datagram = Seal(caller, MakeReliable(1, 30), now);
  const Taken taken = Knock(kHome, datagram);
  EXPECT_EQ(taken.visitor, 0U);
  ASSERT_FALSE(taken.answer.empty());
  EXPECT_LT(taken.answer.size(), datagram.size());
  Bytes forged = taken.answer;
  forged.back() ^= 1U;
  static_cast<void>(caller.TakeDatagram(forged, now));
  EXPECT_EQ(caller.ReadState(), Caller::State::kIn);
  static_cast<void>(caller.TakeDatagram(taken.answer, now));
  EXPECT_EQ(caller.ReadState(), Caller::State::kReset);
  EXPECT_TRUE(Knock(MakeAddress(9, 9, 9, 9, 9), datagram).answer != taken.answer)
      << "who does not have its address cannot ask for it";
}

// The handshake alone over the link of the issue, 10,000 times: all are in within the time that a client waits.
TEST_F(DoorTest, EveryHandshakeSucceedsOverABadLink) {
  constexpr int kCallers = 10'000;
  Door::Settings settings;
  settings.maxVisitors = kMaxVisitors;
  std::mt19937_64 random(20261123);
  const auto draw = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  double slowest = 0;
  int failed = 0;
  for (int i = 0; i < kCallers; ++i) {
    if (i % 2000 == 0) Open(settings);
    const NetAddress from = MakeAddress(10, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i), 1, 7);
    Caller caller = MakeCaller();
    const double begin = now;
    std::multimap<double, Bytes> toDoor, toCaller;
    const auto send = [&](std::multimap<double, Bytes>& way, const Bytes& bytes) {
      for (int copies = draw() < 0.05 ? 2 : 1; copies > 0; --copies) {
        const double held = draw() < 0.04 ? 0.05 : 0;
        if (draw() >= 0.2) way.emplace(now + 0.1 + 0.05 * draw() + held, bytes);
      }
    };
    double nextConnect = 0;  // ENet tries again by itself
    while (caller.ReadState() != Caller::State::kIn && now < begin + 8) {
      Bytes datagram;
      caller.FindDue(now, datagram);
      if (!datagram.empty()) send(toDoor, datagram);
      if (caller.CanSeal() && now >= nextConnect) {
        send(toDoor, Seal(caller, MakeConnect(static_cast<std::uint32_t>(i + 1)), now));
        nextConnect = now + 0.5;
      }
      for (; !toDoor.empty() && toDoor.begin()->first <= now; toDoor.erase(toDoor.begin())) {
        const Taken taken = Knock(from, toDoor.begin()->second);
        if (!taken.answer.empty()) send(toCaller, taken.answer);
      }
      for (; !toCaller.empty() && toCaller.begin()->first <= now; toCaller.erase(toCaller.begin())) {
        static_cast<void>(caller.TakeDatagram(toCaller.begin()->second, now));
      }
      now += 1.0 / 60;
    }
    failed += caller.ReadState() == Caller::State::kIn ? 0 : 1;
    slowest = std::max(slowest, now - begin);
  }
  EXPECT_EQ(failed, 0);
  std::printf("slowest of %d handshakes: %.2f s\n", kCallers, slowest);
}

}  // namespace
}  // namespace wobble::transport::vestibule
