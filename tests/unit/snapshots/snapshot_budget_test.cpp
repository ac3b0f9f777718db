// The choice of bodies for a client: the budget holds, no body starves, the own body goes first.
#include "server/snapshots/snapshot_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

#include "tests/support/game.h"

namespace wobble::server {
namespace {

constexpr double kOverhead = 44;  // bytes of IPv4, UDP and ENet per packet

class RecordingTransport final : public transport::Transport {
 public:
  void Poll(double, const Sink&) override {}
  transport::SendResult Send(transport::ConnectionId, transport::Channel channel,
                             std::span<const std::uint8_t> message) override {
    EXPECT_EQ(channel, transport::Channel::kSnapshot);
    packets.emplace_back(message.begin(), message.end());
    return transport::SendResult::kQueued;
  }
  void Disconnect(transport::ConnectionId) override {}
  void Flush() override {}
  [[nodiscard]] transport::Statistics ReadStatistics() const override { return {}; }

  std::vector<std::vector<std::uint8_t>> packets;
};

// What a ball's record takes at each quality, as a share of the finest: 137 to 18 bytes in a crowd on `pitch`.
constexpr std::array<double, kQualities> kBytesOfQuality{1, 0.8, 0.6, 0.42, 0.3, 0.185, 0.135};

class SnapshotBudgetTest : public testing::Test {
 public:
  // SnapshotBudget does not read payloads, so any bytes will do. payloadBytes: at the finest quality.
  void AddBody(std::uint32_t id, protocol::Vector3 centre, std::size_t payloadBytes, std::size_t patches = 1) {
    for (std::size_t quality = 0; quality < kQualities; ++quality) {
      Stored& made = stored[id][quality];
      made = {};
      const auto share = kBytesOfQuality[quality] * static_cast<double>(payloadBytes);
      const std::vector<std::uint8_t> payload(std::max<std::size_t>(1, static_cast<std::size_t>(share)),
                                              static_cast<std::uint8_t>(id));
      for (std::size_t patch = 0; patch < patches; ++patch) {
        protocol::AppendRecord({id, 0, static_cast<std::uint8_t>(patch)}, payload, made.bytes.emplace_back());
      }
      made.records.assign(made.bytes.begin(), made.bytes.end());
      made.body = {made.records, 100, 0};
    }
    bodies.push_back({.body = id, .centre = centre, .size = 0.5F});
  }
  void RemoveBody(std::uint32_t id) {
    std::erase_if(bodies, [&](const ShownBody& body) { return body.body == id; });
  }

  // Stands in for the SnapshotStore that SnapshotBudget asks.
  friend class SnapshotBudget;
  [[nodiscard]] std::span<const ShownBody> Bodies() const { return bodies; }
  const EncodedBody& Read(std::size_t index, std::size_t quality) {
    ++recordsRead;
    qualities[bodies[index].body] = quality;
    return stored[bodies[index].body][quality].body;
  }

  // Sends one snapshot; returns the bodies sent, in order, and checks every packet.
  std::vector<std::uint32_t> Send(double creditBytes, std::uint32_t own = 0) {
    transport.packets.clear();
    ++tick;
    protocol::SnapshotHead head;
    head.tick = tick;
    head.inputTick = 17;
    const SnapshotTask task{.connection = 1,
                            .ownBody = own,
                            .head = head,
                            .subset = subset,
                            .creditBytes = creditBytes,
                            .now = tick / 30.0,
                            .download = &download};
    budget.Spend(*this, task, subscription);
    std::vector<std::uint32_t> sent;
    for (const auto& packet : transport.packets) {
      EXPECT_LE(packet.size(), protocol::kMaxPacketBytes);
      bytes += static_cast<double>(packet.size()) + kOverhead;
      protocol::SnapshotHead read;
      std::vector<protocol::Record> inPacket;
      EXPECT_EQ(protocol::ReadSnapshot(packet, read, inPacket), protocol::SnapshotResult::kOk);
      EXPECT_EQ(read.sequence, ++sequence);
      EXPECT_EQ(read.tick, tick);
      EXPECT_EQ(read.inputTick, 17U);
      for (const protocol::Record& record : inPacket) {
        if (record.head.patch == 0) sent.push_back(record.head.body);
        ++recordsSent;
      }
    }
    return sent;
  }

  // Of two blueprints, of which the client has kept the first and reports it.
  static Download MakeArrived() {
    BlueprintCaptures captures(std::vector<Bases>(2));
    const scenes::Scene scene = test::MakeYard("[[blueprint]]\nname = \"b\"\nsubdivisions = 1\nmass = 5\n");
    physics::World world(scenes::MakeWorldSettings(scene, 1.0 / 60, 1));
    static_cast<void>(scenes::FillWorld(scene, 1, world));
    captures.Follow(world, nullptr);
    Download made;
    made.Begin(0, 1, 0, std::array{captures[0].hash});
    made.SendDue({}, captures, [](const protocol::Message&) {});
    EXPECT_TRUE(made.TakeReport(protocol::kKeptPieceBytes));
    return made;
  }

  struct Stored {
    std::vector<std::vector<std::uint8_t>> bytes;  // of each patch
    std::vector<std::span<const std::uint8_t>> records;
    EncodedBody body;
  };
  std::map<std::uint32_t, std::array<Stored, kQualities>> stored;
  std::map<std::uint32_t, std::size_t> qualities;  // asked for last, by body
  std::vector<ShownBody> bodies;
  RecordingTransport transport;
  SnapshotBudget budget{transport, 250};
  Subscription subscription;
  Download download = MakeArrived();
  BodySubset subset;
  std::uint32_t tick = 0;
  std::uint32_t sequence = 0;
  std::uint64_t recordsSent = 0;
  std::uint64_t recordsRead = 0;  // calls of Read
  double bytes = 0;               // all headers counted
};

constexpr double kShare384 = 384e3 / 8 / 30;  // bytes per snapshot at --client-kbit 384 and 30 Hz

TEST_F(SnapshotBudgetTest, SendsNoBodyWhoseBlueprintHasNotBeenSent) {
  AddBody(1, {1, 0, 0}, 200);
  AddBody(2, {2, 0, 0}, 200);
  bodies[1].blueprint = 1;
  EXPECT_EQ(Send(kShare384), std::vector<std::uint32_t>{1});
  download.Renew(0);
  EXPECT_TRUE(Send(kShare384).empty());
}

TEST_F(SnapshotBudgetTest, ASmallWorldGoesOutWhole) {
  for (std::uint32_t id = 1; id <= 5; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 200);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(Send(kShare384, 3).size(), 5U);
  EXPECT_EQ(budget.Counts().bodiesLeftOut, 0U);
  EXPECT_EQ(budget.Counts().packets, sequence);
}

TEST_F(SnapshotBudgetTest, TheBudgetHoldsOverTime) {
  for (std::uint32_t id = 1; id <= 60; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 100 + 13 * (id % 17));
  for (int i = 0; i < 1800; ++i) {
    Send(kShare384, 1);
    // The credit so far, and over that at most one body and one packet's headers.
    EXPECT_LE(bytes, kShare384 * (i + 2) + 400 + 60);
  }
  EXPECT_GT(bytes, 0.98 * kShare384 * 1800);  // and the budget is used
  EXPECT_GT(budget.Counts().bodiesLeftOut, 0U);
}

TEST_F(SnapshotBudgetTest, TheSmallestBudgetHoldsAtTheHighestRateAndStillFeeds) {
  // 32 kbit/s at 480 Hz: a share is smaller than a packet's headers.
  const double credit = 32e3 / 8 / 480;
  for (std::uint32_t id = 1; id <= 3; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 300);
  std::map<std::uint32_t, int> times;
  for (int i = 0; i < 480 * 20; ++i) {
    for (const std::uint32_t id : Send(credit, 2)) ++times[id];
  }
  EXPECT_LE(bytes, credit * 480 * 20 + 400);
  EXPECT_GT(times[2], 20 * 5);  // the own body, several times a second
}

TEST_F(SnapshotBudgetTest, EachGetsItsTurnWhenABodysTurnIsEverySecondTick) {
  for (std::uint32_t id = 1; id <= 40; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 20);
  for (std::uint32_t i = 0; i < 60; ++i) {
    subset = {.remainder = i % 2, .divisor = 2};
    const std::vector<std::uint32_t> sent = Send(kShare384 / 2, 7);
    EXPECT_EQ(sent.size(), 20U);
    for (const std::uint32_t id : sent) EXPECT_EQ(id % 2, i % 2);
    EXPECT_EQ(sent.front() == 7, i % 2 == 1);
  }
  bodies.clear();
  std::size_t heads = 0;
  for (std::uint32_t i = 0; i < 60; ++i) {
    subset = {.remainder = i % 2, .divisor = 2};
    Send(kShare384 / 2, 7);
    heads += transport.packets.size();
  }
  EXPECT_EQ(heads, 30U) << "with nothing to tell no more often than without turns";
}

TEST_F(SnapshotBudgetTest, TheOwnBodyIsNotStarvedByThoseWhoseTurnIsAnotherTick) {
  const double credit = 32e3 / 8 / 60;  // the smallest budget, half of a share at 30 Hz
  for (std::uint32_t id = 1; id <= 40; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 100);
  std::map<std::uint32_t, int> times;
  for (std::uint32_t i = 0; i < 60 * 20; ++i) {
    subset = {.remainder = i % 2, .divisor = 2};
    for (const std::uint32_t id : Send(credit, 7)) ++times[id];
  }
  EXPECT_GT(times[7], 20 * 5);
}

TEST_F(SnapshotBudgetTest, WhatIsNotSentIsNotAskedFor) {
  for (std::uint32_t id = 1; id <= 500; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 400);
  std::size_t sent = 0;
  for (int i = 0; i < 100; ++i) sent += Send(kShare384, 1).size();
  EXPECT_EQ(recordsRead, sent);
}

TEST_F(SnapshotBudgetTest, AQuietMinuteBuysNoBurst) {
  AddBody(1, {}, 50);
  for (int i = 0; i < 1800; ++i) Send(kShare384, 1);
  for (std::uint32_t id = 2; id <= 100; ++id) AddBody(id, {}, 300);
  bytes = 0;
  Send(kShare384, 1);
  EXPECT_LE(bytes, 2 * kShare384 + 400 + 60);
}

TEST_F(SnapshotBudgetTest, TheOwnBodyIsFirstEachTime) {
  for (std::uint32_t id = 1; id <= 80; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 200);
  for (int i = 0; i < 300; ++i) {
    const auto sent = Send(kShare384, 57);
    ASSERT_FALSE(sent.empty());
    EXPECT_EQ(sent[0], 57U);
    EXPECT_EQ(std::count(sent.begin(), sent.end(), 57U), 1);
  }
}

TEST_F(SnapshotBudgetTest, NoBodyWaitsLongerThanAClientRemembers) {
  // The scene `crowd` with 32 players on it, seen from its middle: 1,000 balls and 32 larger on 60 m by 60 m, all of
  // 162 vertices. A client forgets a body after 30 s.
  std::uint32_t id = 0;
  for (int x = 0; x < 40; ++x) {
    for (int y = 0; y < 25; ++y) {
      AddBody(++id, {-27.0F + 1.384F * static_cast<float>(x), -27.0F + 2.25F * static_cast<float>(y), 0.4F}, 230);
    }
  }
  for (int i = 0; i < 32; ++i) AddBody(++id, {static_cast<float>(i % 8) - 4, static_cast<float>(i % 5), 0.5F}, 230);
  std::map<std::uint32_t, std::uint32_t> last;
  std::uint32_t longest = 0;
  for (int i = 0; i < 1800; ++i) {
    for (const std::uint32_t sent : Send(kShare384, 1010)) {
      longest = std::max(longest, tick - last[sent]);
      last[sent] = tick;
    }
  }
  for (const ShownBody& body : bodies) longest = std::max(longest, tick - last[body.body]);
  RecordProperty("longest_wait_ms", static_cast<int>(longest * 1000 / 30));
  std::printf("longest wait of %u bodies: %.2f s\n", id, longest / 30.0);
  EXPECT_LT(longest, 15U * 30);
}

TEST_F(SnapshotBudgetTest, NearBodiesComeMoreOftenThanFarOnes) {
  AddBody(1, {}, 200);
  for (std::uint32_t id = 2; id <= 21; ++id) AddBody(id, {2, 0, 0}, 200);
  for (std::uint32_t id = 22; id <= 41; ++id) AddBody(id, {60, 0, 0}, 600);
  std::map<std::uint32_t, int> times;
  for (int i = 0; i < 900; ++i) {
    for (const std::uint32_t id : Send(kShare384, 1)) ++times[id];
  }
  EXPECT_EQ(times[1], 900);
  for (std::uint32_t id = 2; id <= 21; ++id) {
    EXPECT_GT(times[id], 3 * times[id + 20]);
    EXPECT_GT(times[id + 20], 10);
  }
}

TEST_F(SnapshotBudgetTest, PrioritiesSurviveRemovals) {
  for (std::uint32_t id = 1; id <= 30; ++id) AddBody(id, {1, 0, 0}, 300);
  for (int i = 0; i < 7; ++i) Send(kShare384);
  std::map<std::uint32_t, float> before;
  for (const auto& interest : subscription.interests) before[interest.body] = interest.priority;
  for (const std::uint32_t id : {1U, 2U, 15U, 30U}) RemoveBody(id);
  AddBody(31, {1, 0, 0}, 300);
  // So deep in debt that nothing can be sent.
  subscription.credit = -1000;
  EXPECT_TRUE(Send(1).empty());
  ASSERT_EQ(subscription.interests.size(), 27U);
  for (std::size_t i = 0; i < 27; ++i) {
    const auto& interest = subscription.interests[i];
    EXPECT_EQ(interest.body, bodies[i].body);
    EXPECT_GT(interest.priority, before[interest.body]) << interest.body;
    EXPECT_LT(interest.priority, before[interest.body] + 1.26F) << "one growth, 1.25 at most of what does not move";
  }
}

TEST_F(SnapshotBudgetTest, ALargeBodysPatchesGoTogether) {
  AddBody(1, {}, 1100, 8);
  AddBody(2, {}, 200);
  const auto sent = Send(20000, 1);
  EXPECT_EQ(sent.size(), 2U);
  EXPECT_EQ(recordsSent, 9U);
  EXPECT_GE(transport.packets.size(), 8U);
}

TEST_F(SnapshotBudgetTest, WhatRestsIsSentUntilItIsThere) {
  AddBody(1, {}, 100);
  AddBody(2, {2, 0, 0}, 100);
  bodies[1].restTick = 5;
  EXPECT_EQ(Send(kShare384, 1).size(), 2U);
  EXPECT_EQ(Send(kShare384, 1).size(), 1U) << "it is on its way";
  protocol::SentWindow::Report report;
  ASSERT_TRUE(subscription.TakeAcknowledgement(sequence, 1, tick / 30.0, report));
  for (int i = 0; i < 600; ++i) EXPECT_EQ(Send(kShare384, 1).size(), 1U);
  bodies[1].restTick = 0;
  EXPECT_EQ(Send(kShare384, 1).size(), 2U) << "it wakes";
  bodies[1].restTick = tick;
  EXPECT_EQ(Send(kShare384, 1).size(), 2U) << "and rests somewhere else";
}

TEST_F(SnapshotBudgetTest, WithoutAcknowledgementsWhatRestsComesAgainAndAgain) {
  AddBody(1, {}, 100);
  bodies[0].restTick = 5;
  int times = 0;
  for (int i = 0; i < 300; ++i) times += static_cast<int>(Send(kShare384).size());
  EXPECT_GE(times, 15);
  EXPECT_LE(times, 30);
}

TEST_F(SnapshotBudgetTest, AWorldAtRestIsToldByHeadsAlone) {
  for (std::uint32_t id = 1; id <= 20; ++id) {
    AddBody(id, {static_cast<float>(id), 0, 0}, 100, 2);
    bodies.back().restTick = 3;
  }
  protocol::SentWindow::Report report;
  for (int i = 0; i < 20; ++i) {
    Send(kShare384);
    ASSERT_TRUE(subscription.TakeAcknowledgement(sequence, ~std::uint64_t{0} >> (64 - std::min(64U, sequence)) >> 1,
                                                 tick / 30.0, report));
  }
  EXPECT_TRUE(Send(kShare384).empty());
  ASSERT_EQ(transport.packets.size(), 1U);
  EXPECT_EQ(transport.packets[0].size(), protocol::kSnapshotHeadBytes);
}

TEST_F(SnapshotBudgetTest, WhatIsOutOfViewIsNotSentButCounted) {
  AddBody(1, {}, 100);
  AddBody(2, {249, 0, 0}, 100);
  AddBody(3, {0, 251, 0}, 100);
  EXPECT_EQ(Send(kShare384, 1), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(budget.Counts().bodiesOutOfView, 1U);
  EXPECT_EQ(budget.Counts().bodiesLeftOut, 0U);
}

TEST_F(SnapshotBudgetTest, FastBodiesComeMoreOftenThanSlowOnes) {
  for (std::uint32_t id = 1; id <= 40; ++id) {
    AddBody(id, {30, 0, 0}, 1100);
    bodies.back().speed = id <= 20 ? 8.0F : 0.0F;
  }
  std::map<std::uint32_t, int> times;
  for (int i = 0; i < 900; ++i) {
    for (const std::uint32_t id : Send(kShare384)) ++times[id];
  }
  for (std::uint32_t id = 1; id <= 20; ++id) {
    EXPECT_GT(times[id], 1.6 * times[id + 20]);
    EXPECT_LT(times[id], 2.4 * times[id + 20]);
  }
}

TEST_F(SnapshotBudgetTest, QualityFallsWithDistanceAndBeforeTheRate) {
  AddBody(1, {}, 100);
  AddBody(2, {5, 0, 0}, 100);
  AddBody(3, {20, 0, 0}, 100);
  AddBody(4, {50, 0, 0}, 100);
  Send(kShare384, 1);
  EXPECT_EQ(qualities, (std::map<std::uint32_t, std::size_t>{{1, 0}, {2, 0}, {3, 2}, {4, 4}}));
  EXPECT_EQ(budget.Counts().bodiesCoarsened, 2U);
  // With a crowd all bodies are coarser, near ones no more than to 1 %, and after it finer again.
  for (std::uint32_t id = 5; id <= 60; ++id) AddBody(id, {1, 0, 0}, 200);
  for (int i = 0; i < 40; ++i) Send(kShare384, 1);
  EXPECT_EQ(qualities[1], 4U);
  EXPECT_EQ(qualities[2], 6U);
  for (std::uint32_t id = 5; id <= 60; ++id) RemoveBody(id);
  for (int i = 0; i < 300; ++i) Send(kShare384, 1);
  EXPECT_EQ(qualities[2], 0U);
}

// 24 others around, and many beyond them: what a budget cannot hold.
TEST_F(SnapshotBudgetTest, TheNearestComeInEverySnapshotOfACrowd) {
  AddBody(1, {}, 133);
  for (std::uint32_t id = 2; id <= 25; ++id) AddBody(id, {0.2F * static_cast<float>(id), 0, 0}, 133);
  for (std::uint32_t id = 26; id <= 128; ++id) AddBody(id, {5 + 0.1F * static_cast<float>(id), 0, 0}, 133);
  for (int i = 0; i < 300; ++i) Send(kShare384, 1);
  const double before = bytes;
  std::map<std::uint32_t, int> times;
  std::map<std::uint32_t, std::size_t> coarsest;
  for (int i = 0; i < 300; ++i) {
    for (const std::uint32_t id : Send(kShare384, 1)) {
      ++times[id];
      coarsest[id] = std::max(coarsest[id], qualities[id]);
    }
  }
  EXPECT_NEAR(bytes - before, kShare384 * 300, 0.02 * kShare384 * 300);
  for (std::uint32_t id = 1; id <= 25; ++id) {
    EXPECT_EQ(times[id], 300) << id;
    EXPECT_LE(coarsest[id], 4U) << id;
  }
  for (std::uint32_t id = 26; id <= 128; ++id) EXPECT_GE(times[id], 10) << id << ": one a second";
}

TEST_F(SnapshotBudgetTest, ALargeBodyBesideTheViewerStarvesNoOther) {
  AddBody(1, {}, 100);
  for (std::uint32_t id = 2; id <= 6; ++id) AddBody(id, {static_cast<float>(id), 0, 0}, 1100, 6);
  for (std::uint32_t id = 7; id <= 40; ++id) AddBody(id, {20, 0, 0}, 100);
  std::map<std::uint32_t, int> times;
  for (int i = 0; i < 300; ++i) {
    for (const std::uint32_t id : Send(kShare384, 1)) ++times[id];
  }
  for (std::uint32_t id = 1; id <= 40; ++id) EXPECT_GE(times[id], 10) << id << ": one a second";
}

TEST_F(SnapshotBudgetTest, WhatLooksLargeIsSentLikeWhatIsNear) {
  AddBody(1, {}, 100);
  AddBody(2, {30, 0, 0}, 100);
  AddBody(3, {30, 0, 0}, 100);
  bodies[2].size = 5;
  Send(kShare384, 1);
  EXPECT_EQ(qualities[2], 2U);
  EXPECT_EQ(qualities[3], 0U);
}

TEST_F(SnapshotBudgetTest, AMachineShortOfTimeEncodesEachBodyTwiceAtMost) {
  AddBody(1, {}, 20);
  AddBody(2, {5, 0, 0}, 20);
  AddBody(3, {9, 0, 0}, 20);
  AddBody(4, {50, 0, 0}, 20);
  budget.SetCoarser(true);
  Send(kShare384, 1);
  EXPECT_EQ(qualities, (std::map<std::uint32_t, std::size_t>{{1, 2}, {2, 2}, {3, 4}, {4, 4}}));
  budget.SetCoarser(false);
  Send(kShare384, 1);
  EXPECT_EQ(qualities, (std::map<std::uint32_t, std::size_t>{{1, 0}, {2, 0}, {3, 0}, {4, 4}}));
}

TEST_F(SnapshotBudgetTest, CountsWhatWasSent) {
  AddBody(1, {}, 100);
  stored[1][0].body.errorSquares = 100 * 0.0025 * 0.0025;
  Send(kShare384);
  Send(kShare384);
  EXPECT_EQ(budget.Counts().vertices, 200U);
  EXPECT_NEAR(budget.Counts().BitsPerVertex(), 8 * 103 / 100.0, 1e-9);
  EXPECT_NEAR(budget.Counts().ErrorPercentRms(), 0.25, 1e-9);
}

TEST_F(SnapshotBudgetTest, AnEmptyWorldIsToldByAHeadAlone) {
  EXPECT_TRUE(Send(kShare384).empty());
  ASSERT_EQ(transport.packets.size(), 1U);
  EXPECT_EQ(transport.packets[0].size(), protocol::kSnapshotHeadBytes);
}

}  // namespace
}  // namespace wobble::server
