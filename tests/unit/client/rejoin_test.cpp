// Joining again after being cut off: when it is tried, when it is not, and when it is given up.
#include "client/rejoin.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "client/lasting_client.h"
#include "tests/unit/client/scripted_server.h"

namespace wobble::client {
namespace {

using Kind = transport::Event::Kind;

// Moments at which tries begin, seconds after a loss at 100, when each try fails after `tryTime`.
std::vector<double> ListTries(const RejoinOptions& options, double tryTime, double& gaveUpAt) {
  RejoinPlan plan(options);
  plan.NotePlaying(0);
  plan.NoteEnd(100, true);
  std::vector<double> tries;
  double now = 100;
  for (; plan.ReadState() != RejoinPlan::State::kOver; now += 0.01) {
    if (plan.TakeDue(now)) tries.push_back(now - 100);
    if (plan.ReadState() == RejoinPlan::State::kTrying && now - 100 >= tries.back() + tryTime) plan.NoteEnd(now, true);
  }
  gaveUpAt = now - 100;
  return tries;
}

TEST(RejoinPlan, WaitsGrowAreShortenedByChanceAndEnd) {
  std::set<double> firsts;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    double gaveUpAt = 0;
    const std::vector<double> tries = ListTries({.seed = seed}, 0.5, gaveUpAt);
    double wait = 0.25, before = 0;
    for (const double at : tries) {
      EXPECT_GE(at - before, wait / 2 - 0.02) << "seed " << seed;
      EXPECT_LE(at - before, wait + 0.02) << "seed " << seed;
      before = at + 0.5;
      wait = std::min(2 * wait, RejoinOptions{}.longestWait);
    }
    EXPECT_GE(tries.size(), 13U);
    EXPECT_NEAR(gaveUpAt, 60, 0.03);
    firsts.insert(tries[0]);
    EXPECT_EQ(ListTries({.seed = seed}, 0.5, gaveUpAt), tries);
  }
  EXPECT_GE(firsts.size(), 8U);  // of 13 hundredths of a second
}

TEST(RejoinPlan, SaysWhyItHasGivenUp) {
  EXPECT_EQ(DescribeGivingUp("lost", "full", {.patience = 60}), "lost; gave up joining again after 60 s: full");
  EXPECT_EQ(DescribeGivingUp("lost", "", {.patience = 2.5}), "lost; gave up joining again after 2.5 s");
}

TEST(RejoinPlan, ATryThatDoesNotEndIsGivenUp) {
  double gaveUpAt = 0;
  EXPECT_EQ(ListTries({.patience = 7}, 1000, gaveUpAt).size(), 1U);
  EXPECT_NEAR(gaveUpAt, 7, 0.03);
}

TEST(RejoinPlan, WhoHasNotPlayedDoesNotReturn) {
  RejoinPlan plan({});
  plan.NoteEnd(1, true);
  EXPECT_EQ(plan.ReadState(), RejoinPlan::State::kOver);
  EXPECT_FALSE(plan.TakeDue(100));
}

// A server that lets in and loses again within kSettled is followed for 60 s without play; one that was good for longer
// has all patience again.
TEST(RejoinPlan, PatienceIsSpentByTimeWithoutPlay) {
  for (const double played : {kSettled - 1, kSettled + 1}) {
    RejoinPlan plan({});
    plan.NotePlaying(0);
    double now = played, away = 0;
    plan.NoteEnd(now, true);
    for (int losses = 0; losses < 100 && plan.ReadState() != RejoinPlan::State::kOver; now += 0.01) {
      away += 0.01;
      if (!plan.TakeDue(now)) continue;
      plan.NotePlaying(now);
      now += played;
      plan.NoteEnd(now, true);
      ++losses;
    }
    if (played < kSettled) {
      EXPECT_EQ(plan.ReadState(), RejoinPlan::State::kOver);
      EXPECT_NEAR(away, 60, 5.1);
    } else {
      EXPECT_EQ(plan.ReadState(), RejoinPlan::State::kWaiting);
      EXPECT_LT(away, 100 * 0.3);  // always the first wait
    }
  }
}

// A lasting client, and a scripted server for each of its connections.
class LastingClientTest : public testing::Test {
 protected:
  void Start(const RejoinOptions& rejoin = {}, const Options& options = {}) {
    links.clear();
    prepared = 0;
    LastingOptions lasting{.client = options,
                           .rejoin = rejoin,
                           .connect = [this](std::string& error) { return Connect(error); },
                           .prepare = [this](Client&) { ++prepared; }};
    std::string error;
    auto transport = Connect(error);
    player = std::make_unique<LastingClient>(std::move(transport), std::move(lasting), now);
  }
  std::unique_ptr<transport::Transport> Connect(std::string& error) {
    if (!canConnect) {
      error = "no such host";
      return nullptr;
    }
    links.push_back(std::make_unique<Link>());
    return std::make_unique<ScriptedTransport>(*links.back());
  }
  void Arrive(Kind kind, Message bytes = {}) {
    links.back()->arrivals.push_back({now, kind, Channel::kControl, std::move(bytes)});
    player->Update(now);
  }
  void Say(wire::GoodbyeReason reason) { Arrive(Kind::kMessage, protocol::MakeServerGoodbye(reason, "")); }
  // The server of the newest connection lets it in. keeps: the client has the blueprint already.
  void LetIn(bool keeps = false) {
    Arrive(Kind::kConnected);
    Arrive(Kind::kMessage, protocol::MakeWelcome({.clientId = 9,
                                                  .ownBody = 3,
                                                  .tick = 100,
                                                  .tickHz = kTickHz,
                                                  .snapshotHz = 30,
                                                  .scene = "arena",
                                                  .blueprintCount = 1,
                                                  .obstacles = {}}));
    const Message strip = MakeStrip();
    const auto size = static_cast<std::uint32_t>(strip.size());
    if (keeps)
      return Arrive(Kind::kMessage, protocol::MakeBlueprintChunk(0, protocol::HashBytes(strip), size, size, {}, 0));
    for (const Message& chunk : CutIntoChunks(0, strip, 4096)) Arrive(Kind::kMessage, chunk);
  }
  void Play(const RejoinOptions& rejoin = {}, const Options& options = {}) {
    Start(rejoin, options);
    LetIn();
    ASSERT_EQ(player->ReadState(), LastingState::kPlaying);
  }
  // Updates until there is a connection more, for 10 s at most.
  void AwaitTry() {
    const std::size_t before = links.size();
    for (const double end = now + 10; now < end && links.size() == before;) player->Update(now += 0.01);
    ASSERT_EQ(links.size(), before + 1);
  }
  // The hello of the newest connection.
  [[nodiscard]] const wire::Hello* Hello() const {
    const wire::ClientMessage* message = nullptr;
    EXPECT_EQ(protocol::ParseClientMessage(links.back()->sent.at(0).bytes, message), protocol::ParseResult::kOk);
    return message->body_as_Hello();
  }

  bool canConnect = true;
  std::vector<std::unique_ptr<Link>> links;
  int prepared = 0;
  double now = 50;
  std::unique_ptr<LastingClient> player;  // before the links
};

TEST_F(LastingClientTest, ComesBackUnderItsNameAndDownloadsNothingTwice) {
  std::vector<std::uint64_t> kept;
  Options options{.name = "mira", .spectator = true};
  options.keep = [&](std::uint64_t hash, std::span<const std::uint8_t>) { kept.push_back(hash); };
  Play({}, options);
  EXPECT_EQ(Hello()->kept()->size(), 0U);
  const Client* first = &player->Current();
  now += 20;
  Arrive(Kind::kDisconnected);
  EXPECT_EQ(player->ReadState(), LastingState::kRejoining);
  EXPECT_EQ(player->Reason(), "connection lost");
  EXPECT_EQ(&player->Current(), first);  // its world is still to be seen
  EXPECT_EQ(player->Current().Welcome().scene, "arena");

  AwaitTry();
  Arrive(Kind::kConnected);
  EXPECT_EQ(Hello()->name()->str(), "mira");
  EXPECT_EQ(Hello()->role(), wire::Role::Spectator);
  ASSERT_EQ(Hello()->kept()->size(), 1U);
  EXPECT_EQ(Hello()->kept()->Get(0), protocol::HashBytes(MakeStrip()));
  LetIn(true);
  EXPECT_EQ(player->ReadState(), LastingState::kPlaying) << player->Reason();
  EXPECT_EQ(player->Reason(), "");
  EXPECT_EQ(player->CountRejoins(), 1U);
  EXPECT_NE(&player->Current(), first);
  EXPECT_EQ(prepared, 2);
  EXPECT_EQ(kept.size(), 1U);  // the embedder heard of the one download
}

TEST_F(LastingClientTest, OnlySomeEndsAreWorthAnotherTry) {
  using enum wire::GoodbyeReason;
  for (const auto reason : {Left, ServerClosing, ServerFull, WrongVersion, WrongSchema, NoHello, Silent, BadMessages,
                            Busy, TooMuch, Kicked, Banned, BadToken, TooManyFromAddress}) {
    const bool isPassing = reason == ServerClosing || reason == ServerFull || reason == NoHello || reason == Silent ||
                           reason == Busy || reason == TooManyFromAddress;
    Play();
    Say(reason);
    EXPECT_EQ(player->ReadState(), isPassing ? LastingState::kRejoining : LastingState::kEnded)
        << protocol::Name(reason);
    EXPECT_EQ(player->Reason(), protocol::Name(reason));
    EXPECT_EQ(player->EndedUnasked(), !isPassing);

    // The same at a return: who is full or busy is asked again.
    Play();
    Arrive(Kind::kDisconnected);
    AwaitTry();
    Arrive(Kind::kConnected);
    Say(reason);
    EXPECT_EQ(player->ReadState(), isPassing ? LastingState::kRejoining : LastingState::kEnded)
        << protocol::Name(reason);
    EXPECT_EQ(player->Reason(), isPassing ? "connection lost" : protocol::Name(reason));
    if (!isPassing) continue;
    AwaitTry();
    LetIn();
    EXPECT_EQ(player->ReadState(), LastingState::kPlaying);
  }
}

TEST_F(LastingClientTest, TheFirstJoinIsTriedOnce) {
  for (const auto reason : {wire::GoodbyeReason::ServerFull, wire::GoodbyeReason::Busy}) {
    Start();
    Arrive(Kind::kConnected);
    Say(reason);
    EXPECT_EQ(player->ReadState(), LastingState::kEnded);
    EXPECT_EQ(player->Reason(), protocol::Name(reason));
  }
  Start();
  player->Update(now += protocol::kSilenceTimeout + 0.1);
  EXPECT_EQ(player->ReadState(), LastingState::kEnded);
  EXPECT_EQ(player->Reason(), "no answer from the server");
  EXPECT_EQ(links.size(), 1U);
}

TEST_F(LastingClientTest, SilenceIsALossAndAServerThatStaysAwayTheEnd) {
  Play();
  const double begin = now;
  while (player->ReadState() == LastingState::kPlaying) player->Update(now += 0.1);
  EXPECT_EQ(player->Reason(), "server silent for 8 s");
  EXPECT_NEAR(now - begin, protocol::kSilenceTimeout, 0.15);
  const double lost = now;
  while (player->ReadState() == LastingState::kRejoining && now < lost + 100) player->Update(now += 0.1);
  EXPECT_NEAR(now - lost, 60, 0.15);
  EXPECT_EQ(player->Reason(), "server silent for 8 s; gave up joining again after 60 s: no answer from the server");
  EXPECT_TRUE(player->EndedUnasked());
  EXPECT_LE(links.size(), 1U + 60 / 8);  // each try asks for 8 s

  Play({.patience = 2});
  Arrive(Kind::kDisconnected);
  canConnect = false;
  for (const double until = now + 2.1; now < until;) player->Update(now += 0.01);
  EXPECT_EQ(player->ReadState(), LastingState::kEnded);
  EXPECT_EQ(player->Reason(), "connection lost; gave up joining again after 2 s: no such host");
}

TEST_F(LastingClientTest, WithoutPatienceItEndsAsAClientDoes) {
  Play({.patience = 0});
  Arrive(Kind::kDisconnected);
  EXPECT_EQ(player->ReadState(), LastingState::kEnded);
  EXPECT_EQ(player->Reason(), "connection lost");
}

// While it waits, while it tries, and while it plays; none is tried again.
TEST_F(LastingClientTest, LeavesAtAnyTime) {
  for (const bool tries : {false, true}) {
    Play();
    Arrive(Kind::kDisconnected);
    if (tries) AwaitTry();
    player->Leave(now);
    EXPECT_EQ(player->ReadState(), LastingState::kEnded);
    EXPECT_EQ(player->Reason(), "left");
    EXPECT_FALSE(player->EndedUnasked());
  }
  for (const bool returns : {false, true}) {
    Play();
    if (returns) {
      Arrive(Kind::kDisconnected);
      AwaitTry();
      Arrive(Kind::kConnected);  // half in: says goodbye
    }
    const std::size_t connections = links.size();
    player->Leave(now);
    EXPECT_NE(player->ReadState(), LastingState::kEnded);
    Arrive(Kind::kDisconnected);
    EXPECT_EQ(player->ReadState(), LastingState::kEnded);
    EXPECT_EQ(player->Reason(), "left");
    EXPECT_FALSE(player->EndedUnasked());
    for (const double until = now + 5; now < until;) player->Update(now += 0.1);
    EXPECT_EQ(links.size(), connections);
  }
}

}  // namespace
}  // namespace wobble::client
