// The reconciler before a model of Agones, in virtual time: a sidecar that freezes, crashes, answers late, refuses, or
// answers nonsense. The calls pass through the JSON of agones_messages.h.
#include "server/ops/fleet_reconciler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>

#include "server/ops/agones_messages.h"
#include "tests/support/agones_model.h"

namespace wobble::ops {
namespace {

using test::AgonesModel;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Strings = std::vector<std::string>;

const std::string kSetOne = R"(PATCH /v1beta1/counters/players {"count":"1"})";

// A server and its sidecar.
struct Rig {
  enum class Way {
    kAnswers,
    kFrozen,  // takes requests and gives no answer; they have their effect when it thaws, in any order
    kLate,    // every request has its effect, half a second after it has been given up
    kDead,    // nobody listens
  };

  void Run(double seconds) {
    for (const double end = now + seconds; now < end; now += 0.05) {
      if (now >= m_nextHeartbeat) {
        ++wish.heartbeats;
        m_nextHeartbeat = now + 2;
      }
      reconciler.Want(wish);
      for (auto call = reconciler.Next(now); call; call = reconciler.Next(now)) {
        Make(*call);
        ASSERT_LT(++m_calls, 100000) << "it calls without end";
      }
      ASSERT_GT(reconciler.NextTime(now), now) << "it would spin";
      Pass();
    }
  }

  void SetPlayers(std::vector<std::uint32_t> players) {
    wish.players = std::move(players);
    std::ranges::sort(wish.players);
    if (!wish.players.empty()) wish.state = FleetWish::State::kAllocated;
  }

  void Thaw(std::mt19937& random) {
    way = Way::kAnswers;
    std::ranges::shuffle(m_held, random);
    for (Held& each : m_held) each.due = now + std::uniform_real_distribution(0.0, 1.0)(random);
  }

  // Whether the record is what is wished.
  void ExpectAgreement() {
    const bool isAllocated = wish.state == FleetWish::State::kAllocated;
    EXPECT_EQ(model.state, isAllocated ? "Allocated" : "Ready");
    EXPECT_EQ(model.count, static_cast<int>(wish.players.size()));
    Strings values;
    for (const std::uint32_t player : wish.players) values.push_back("player-" + std::to_string(player));
    EXPECT_THAT(model.values, testing::UnorderedElementsAreArray(values));
  }

  // Requests so far without health and looks; forgets them.
  Strings TakeChanges() {
    Strings changes = std::exchange(model.requests, {});
    std::erase_if(changes, [](const std::string& request) {
      return request == "POST /health {}" || request == "GET /gameserver";
    });
    return changes;
  }

  double now = 0;
  Way way = Way::kAnswers;
  AgonesModel model;
  FleetReconciler reconciler;
  FleetWish wish{.state = FleetWish::State::kReady};
  Strings notes;     // for the log
  Strings troubles;  // likewise, one for each call that failed

 private:
  struct Held {
    SidecarRequest request;
    double due = std::numeric_limits<double>::infinity();
  };

  void Make(const FleetCall& call) {
    const double began = now;
    const SidecarRequest request = MakeRequest(call);
    FleetAnswer answer;
    std::string trouble = "no answer";
    switch (way) {
      case Way::kAnswers: {
        const auto [status, body] = model.Take(request.method, request.path, request.body);
        answer = ReadAnswer(call, status, body, trouble);
        break;
      }
      case Way::kFrozen:
      case Way::kLate:
        m_held.push_back({request, way == Way::kLate ? now + 1.5 : std::numeric_limits<double>::infinity()});
        for (int step = 0; step < 20; ++step) {
          now += 0.05;
          Pass();
        }
        break;
      case Way::kDead:
        break;
    }
    if (!trouble.empty()) troubles.push_back(trouble);
    const std::string note = reconciler.Learn(call, answer, began, now);
    if (!note.empty()) notes.push_back(note);
  }

  // What happens in the cluster as time passes.
  void Pass() {
    model.Write(now);
    for (const Held& each : m_held) {
      if (each.due <= now) model.Take(each.request.method, each.request.path, each.request.body);
    }
    std::erase_if(m_held, [this](const Held& each) { return each.due <= now; });
  }

  double m_nextHeartbeat = 0;
  int m_calls = 0;
  std::vector<Held> m_held;
};

TEST(FleetReconciler, ALifeWithoutTrouble) {
  Rig rig;
  rig.Run(1);
  EXPECT_THAT(rig.TakeChanges(), ElementsAre("POST /ready {}", R"(PATCH /v1beta1/counters/players {"count":"0"})",
                                             R"(PATCH /v1beta1/lists/players {"values":[]})"));
  rig.Run(9);
  rig.SetPlayers({7});
  rig.Run(1);
  EXPECT_THAT(rig.TakeChanges(),
              ElementsAre("POST /allocate {}", kSetOne, R"(PATCH /v1beta1/lists/players {"values":["player-7"]})"));
  rig.SetPlayers({7, 4000000000});
  rig.Run(3);
  EXPECT_THAT(rig.TakeChanges(),
              ElementsAre(R"(PATCH /v1beta1/counters/players {"count":"2"})",
                          R"(PATCH /v1beta1/lists/players {"values":["player-4000000000","player-7"]})"));
  rig.ExpectAgreement();
  rig.SetPlayers({});
  rig.Run(60);
  rig.ExpectAgreement();
  rig.TakeChanges();
  rig.wish.state = FleetWish::State::kShutdown;
  rig.Run(60);
  EXPECT_THAT(rig.TakeChanges(), ElementsAre("POST /shutdown {}"));
  EXPECT_EQ(rig.model.state, "Shutdown");
  EXPECT_THAT(rig.notes, IsEmpty());
  EXPECT_EQ(rig.reconciler.Corrections(), 0U);
}

TEST(FleetReconciler, WhileAllAgreesItLooksEveryFiveSecondsAndSetsNothing) {
  Rig rig;
  rig.SetPlayers({1, 2, 3});
  rig.Run(10);
  rig.model.requests.clear();
  rig.Run(600);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(rig.model.requests, "POST /health {}")), 300, 3);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(rig.model.requests, "GET /gameserver")), 120, 2);
  EXPECT_THAT(rig.TakeChanges(), IsEmpty());
}

// The record shows a change only when the sidecar has written it.
TEST(FleetReconciler, ALookRightAfterAChangeIsNoReasonToChangeItAgain) {
  for (int tenths = 0; tenths < 60; ++tenths) {
    SCOPED_TRACE(tenths);
    Rig rig;
    rig.Run(10 + tenths / 10.0);
    rig.TakeChanges();
    rig.SetPlayers({1});
    rig.Run(15);
    EXPECT_EQ(rig.TakeChanges().size(), 3U) << "allocate, count, list";
    EXPECT_THAT(rig.notes, IsEmpty());
    EXPECT_EQ(rig.reconciler.Corrections(), 0U);
  }
}

TEST(FleetReconciler, ManyJoinsAreFewCalls) {
  Rig rig;
  rig.Run(5);
  rig.TakeChanges();
  for (std::uint32_t player = 1; player <= 60; ++player) {
    std::vector<std::uint32_t> players(player);
    std::iota(players.begin(), players.end(), 1U);
    rig.SetPlayers(players);
    rig.Run(0.1);
  }
  rig.Run(10);
  rig.ExpectAgreement();
  EXPECT_LE(rig.TakeChanges().size(), 12U) << "one allocate; count and list every 2 s";
}

// Fault 2: a sidecar that hangs for a moment has been told things that it may do later.
TEST(FleetReconciler, AFrozenSidecarThatDoesItAllLaterIsPutRight) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Rig rig;
    rig.SetPlayers({1});
    rig.Run(6);
    for (int freeze = 0; freeze < 3; ++freeze) {
      rig.way = Rig::Way::kFrozen;
      for (int change = 0; change < 4; ++change) {
        std::vector<std::uint32_t> players(random() % 8);
        std::iota(players.begin(), players.end(), static_cast<std::uint32_t>(random() % 100));
        rig.SetPlayers(players);
        rig.Run(std::uniform_real_distribution(0.1, 4.0)(random));
      }
      rig.Thaw(random);
      rig.Run(std::uniform_real_distribution(0.1, 8.0)(random));
    }
    rig.Run(15);
    rig.ExpectAgreement();
    EXPECT_EQ(rig.model.takenBack, 0);
  }
}

TEST(FleetReconciler, AFrozenSidecarIsToldLittle) {
  Rig rig;
  rig.SetPlayers({1});
  rig.Run(6);
  rig.TakeChanges();
  rig.way = Rig::Way::kFrozen;
  for (std::uint32_t player = 2; player < 20; ++player) {
    rig.SetPlayers({player});
    rig.Run(3);
  }
  std::mt19937 random(1);
  rig.Thaw(random);
  rig.Run(15);
  rig.ExpectAgreement();
  EXPECT_LE(rig.TakeChanges().size(), 3U) << "of 18 changes the first, the last, and that once more";
}

TEST(FleetReconciler, ASidecarThatDoesEverythingTooLateIsPutRight) {
  Rig rig;
  rig.way = Rig::Way::kLate;
  rig.Run(5);
  rig.SetPlayers({1, 2});
  rig.Run(30);
  rig.SetPlayers({2, 3});
  rig.way = Rig::Way::kAnswers;
  rig.Run(15);
  rig.ExpectAgreement();
}

// Fault 3: it has acknowledged `allocate` and crashed before it was written.
TEST(FleetReconciler, AllocatesAgainAfterACrash) {
  Rig rig;
  rig.Run(10);
  rig.SetPlayers({1, 2, 3});
  rig.Run(0.05);
  rig.model.Crash();
  rig.way = Rig::Way::kDead;
  rig.Run(3);
  EXPECT_EQ(rig.model.state, "Ready") << "with three players in it";
  rig.way = Rig::Way::kAnswers;
  rig.Run(8);
  rig.ExpectAgreement();
  EXPECT_GE(rig.reconciler.Corrections(), 1U);
  EXPECT_THAT(rig.notes, ElementsAre(HasSubstr("this server is ready and not allocated")));
}

TEST(FleetReconciler, PutsRightWhatCrashesLoseAtAnyMoment) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Rig rig;
    for (int crash = 0; crash < 12; ++crash) {
      std::vector<std::uint32_t> players(random() % 8);
      std::iota(players.begin(), players.end(), static_cast<std::uint32_t>(random() % 100));
      rig.SetPlayers(players);
      rig.Run(std::uniform_real_distribution(0.05, 3.0)(random));
      rig.model.Crash();
      rig.way = Rig::Way::kDead;
      rig.Run(std::uniform_real_distribution(0.05, 3.0)(random));
      rig.way = Rig::Way::kAnswers;
    }
    rig.Run(15);
    rig.ExpectAgreement();
    EXPECT_EQ(rig.model.takenBack, 0);
  }
}

TEST(FleetReconciler, ReadyAndShutdownAreRepeatedAfterACrashToo) {
  Rig rig;
  rig.Run(0.05);
  rig.model.Crash();
  rig.Run(8);
  rig.ExpectAgreement();
  rig.wish.state = FleetWish::State::kShutdown;
  rig.Run(0.05);
  rig.model.Crash();
  rig.Run(8);
  EXPECT_EQ(rig.model.state, "Shutdown");
}

TEST(FleetReconciler, ASidecarThatComesLateHearsEverything) {
  Rig rig;
  rig.way = Rig::Way::kDead;
  rig.Run(7);
  rig.SetPlayers({5});
  rig.Run(7);
  EXPECT_THAT(rig.model.requests, IsEmpty());
  rig.way = Rig::Way::kAnswers;
  rig.Run(3);
  EXPECT_THAT(rig.TakeChanges(), ElementsAre("POST /ready {}", "POST /allocate {}", kSetOne,
                                             R"(PATCH /v1beta1/lists/players {"values":["player-5"]})"));
  rig.Run(3);
  rig.ExpectAgreement();
}

// Fault 4: entries of players who have gone; and a count that another has changed.
TEST(FleetReconciler, GhostsAreRemoved) {
  Rig rig;
  rig.SetPlayers({1, 2});
  rig.Run(10);
  rig.model.values.push_back("player-99");
  rig.model.values.push_back("a stranger");
  rig.model.count = 40;
  rig.Run(8);
  rig.ExpectAgreement();
  EXPECT_EQ(rig.reconciler.Corrections(), 2U);
  EXPECT_THAT(rig.notes, ElementsAre("counter of players is not what was set; list of players is not what was set"));
}

// What a matchmaker has allocated stays so, and is no mistake.
TEST(FleetReconciler, AnAllocationByOthersStays) {
  Rig rig;
  rig.Run(10);
  rig.model.state = "Allocated";
  rig.TakeChanges();
  rig.Run(60);
  rig.SetPlayers({1});
  rig.Run(10);
  rig.SetPlayers({});
  rig.Run(30);
  EXPECT_THAT(rig.TakeChanges(), Not(Contains(HasSubstr("POST"))));
  EXPECT_EQ(rig.model.takenBack, 0);
  EXPECT_THAT(rig.notes, IsEmpty());
}

TEST(FleetReconciler, AServerThatIsBeingRemovedSetsNothing) {
  for (const char* state : {"Shutdown", "Unhealthy", "Error"}) {
    Rig rig;
    rig.SetPlayers({1});
    rig.Run(10);
    rig.model.state = state;
    rig.Run(8);
    rig.TakeChanges();
    rig.SetPlayers({1, 2});
    rig.Run(20);
    EXPECT_THAT(rig.TakeChanges(), IsEmpty()) << state;
    EXPECT_THAT(rig.notes, ElementsAre("this server is being removed"));
  }
}

TEST(FleetReconciler, WhatTheFleetDoesNotDeclareIsNotSet) {
  Rig rig;
  rig.model.isDeclared = false;
  rig.SetPlayers({1});
  rig.Run(10);
  EXPECT_THAT(rig.troubles, ElementsAre("status 500: counter not found: players"));
  rig.TakeChanges();
  rig.SetPlayers({1, 2});
  rig.Run(60);
  EXPECT_THAT(rig.TakeChanges(), IsEmpty());
  EXPECT_THAT(rig.notes,
              ElementsAre("the fleet declares no counter of players; the fleet declares no list of players"));
  EXPECT_EQ(rig.model.state, "Allocated");
}

TEST(FleetReconciler, MorePlayersThanTheFleetHasRoomFor) {
  Rig rig;
  rig.model.capacity = 2;
  rig.Run(10);
  rig.SetPlayers({1, 2, 3});
  rig.Run(60);
  EXPECT_EQ(rig.model.count, 2);
  EXPECT_THAT(rig.model.values, ElementsAre("player-1", "player-2"));
  EXPECT_THAT(rig.troubles, IsEmpty());
  EXPECT_THAT(rig.notes, ElementsAre("counter of players has room for 2 only; list of players has room for 2 only"));
  rig.SetPlayers({3});
  rig.Run(10);
  rig.ExpectAgreement();
}

// Fault 6, the words; and that it insists, but no faster than every two seconds.
TEST(FleetReconciler, ARefusalIsRepeatedSlowlyAndSaysWhy) {
  Rig rig;
  rig.Run(10);
  rig.TakeChanges();
  rig.model.refusals["/allocate"] = {500, R"({"code":2,"message":"etcd is\nfull"})"};
  rig.SetPlayers({1});
  rig.Run(20);
  EXPECT_THAT(rig.troubles, Contains("status 500: etcd is full"));
  const Strings changes = rig.TakeChanges();
  const auto tries = std::ranges::count(changes, "POST /allocate {}");
  EXPECT_GE(tries, 8);
  EXPECT_LE(tries, 11);
  EXPECT_THAT(changes, Not(Contains("POST /ready {}"))) << "that would offer the world to others";
  rig.model.refusals.clear();
  rig.Run(6);
  rig.ExpectAgreement();
}

// Every record that cannot be read; then it sets what it can without looking.
TEST(FleetReconciler, NonsenseInsteadOfARecord) {
  for (const std::string nonsense :
       {"", "no JSON", "[]", "null", "{}", R"({"status":7})", R"({"status":{"state":7}})",
        R"({"status":{"state":"Ready","counters":{"players":7}}})",
        R"({"status":{"state":"Ready","counters":{"players":{"count":"many"}}}})",
        R"({"status":{"state":"Ready","lists":{"players":{"values":"all"}}}})",
        R"({"status":{"state":"Ready","lists":{"players":{"values":[1]}}}})", "\xff\xfe"}) {
    SCOPED_TRACE(nonsense);
    Rig rig;
    rig.model.refusals["/gameserver"] = {200, nonsense};
    rig.Run(5);
    EXPECT_EQ(rig.model.state, "Ready");
    rig.SetPlayers({1});
    for (const char* path : {"/allocate", "/v1beta1/counters/players", "/v1beta1/lists/players"}) {
      rig.model.refusals[path] = {500, ""};
      rig.Run(6);
      rig.model.refusals.erase(path);
    }
    rig.Run(10);
    rig.ExpectAgreement();
    EXPECT_EQ(std::ranges::count(rig.model.requests, "POST /ready {}"), 1)
        << "a second would offer the world to others";
    EXPECT_THAT(rig.troubles, Contains("the answer cannot be read: " + nonsense));
    rig.model.refusals["/gameserver"] = {503, "upstream\tis away"};
    rig.SetPlayers({1, 2});
    rig.Run(10);
    EXPECT_EQ(rig.model.count, 2);
    EXPECT_THAT(rig.troubles, Contains("status 503: upstream is away"));
  }
}

TEST(FleetReconciler, NumbersThatAreNumbersAndZerosThatAreLeftOut) {
  FleetCall look{.kind = FleetCall::Kind::kLook};
  std::string trouble;
  const FleetAnswer answer = ReadAnswer(
      look, 200,
      R"({"status":{"state":"Reserved","counters":{"players":{"capacity":64}},"lists":{"players":{"capacity":"8"}}}})",
      trouble);
  EXPECT_EQ(trouble, "");
  ASSERT_TRUE(answer.report.counter && answer.report.list);
  EXPECT_EQ(answer.report.state, FleetReport::State::kReady);
  EXPECT_EQ(answer.report.counter->count, 0);
  EXPECT_EQ(answer.report.counter->capacity, 64);
  EXPECT_EQ(answer.report.list->capacity, 8);
  Rig rig;
  rig.model.leavesOutZeros = true;
  rig.SetPlayers({1});
  rig.Run(10);
  rig.SetPlayers({});
  rig.Run(20);
  rig.ExpectAgreement();
  EXPECT_THAT(rig.notes, IsEmpty());
}

}  // namespace
}  // namespace wobble::ops
