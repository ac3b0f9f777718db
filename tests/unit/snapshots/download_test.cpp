// The window of heights and blueprints, and their order.
#include "server/snapshots/download.h"

#include <gtest/gtest.h>

#include "tests/support/game.h"

namespace wobble::server {
namespace {

using protocol::wire::BlueprintChunk;

// Three blueprints of the yard's scene with bases of 60 kB each; nothing but their sizes matters here.
class DownloadTest : public testing::Test {
 protected:
  DownloadTest()
      : world(scenes::MakeWorldSettings(scene, 1.0 / 60, 1)),
        placed(scenes::FillWorld(scene, 1, world)),
        captures(std::vector<Bases>(3, Bases{std::vector<std::uint8_t>(60'000, 1)})) {
    captures.Follow(world, nullptr);
  }
  static scenes::Scene MakeScene() {
    return test::MakeYard(
        "[[blueprint]]\nname = \"b\"\nsubdivisions = 1\nmass = 5\n"
        "[[blueprint]]\nname = \"c\"\nsubdivisions = 1\nmass = 6\n");
  }
  // Sends what is due; the chunks' slots and offsets are added to `sent`.
  void SendDue() {
    download.SendDue(grounds, captures, [&](const protocol::Message& message) {
      const protocol::wire::ServerMessage* parsed = nullptr;
      ASSERT_EQ(protocol::ParseServerMessage(message, parsed), protocol::ParseResult::kOk);
      const BlueprintChunk* chunk = parsed->body_as_BlueprintChunk();
      ASSERT_NE(chunk, nullptr);
      sent.push_back({chunk->blueprint(), chunk->offset()});
      bytes += chunk->bytes()->size();
    });
  }
  struct Sent {
    int slot;
    std::size_t offset;
  };
  [[nodiscard]] std::vector<int> ListSlots() const {  // in the order of their first chunks
    std::vector<int> slots;
    for (const Sent& chunk : sent) {
      if (slots.empty() || slots.back() != chunk.slot) slots.push_back(chunk.slot);
    }
    return slots;
  }

  scenes::Scene scene = MakeScene();
  physics::World world;
  std::vector<scenes::PlacedBody> placed;
  BlueprintCaptures captures;
  std::vector<CapturedGround> grounds;
  Download download;
  std::vector<Sent> sent;
  std::uint32_t bytes = 0;
};

TEST_F(DownloadTest, SendsTheOwnBlueprintFirstAndNeverMoreThanAWindow) {
  ASSERT_EQ(captures.All().size(), 3U);
  download.Begin(0, 3, 1, {});
  std::uint32_t taken = 0;
  for (int round = 0; !download.IsDone(); ++round) {
    ASSERT_LT(round, 100);
    SendDue();
    EXPECT_LE(bytes - taken, protocol::kDownloadWindowBytes + protocol::kBlueprintChunkBytes);
    const std::uint32_t before = bytes;
    SendDue();
    EXPECT_EQ(bytes, before) << "nothing more until the client has taken some";
    taken += std::min(bytes - taken, 10'000U);
    ASSERT_TRUE(download.TakeReport(taken));
    ASSERT_TRUE(download.TakeReport(taken / 2)) << "an older input";
  }
  EXPECT_EQ(ListSlots(), (std::vector<int>{1, 0, 2}));
}

TEST_F(DownloadTest, DoesNotSendWhatTheClientHasKept) {
  const std::uint64_t kept[] = {42, captures[1].hash, captures[2].hash};
  download.Begin(0, 3, 1, kept);
  SendDue();
  EXPECT_TRUE(download.IsDone());
  EXPECT_EQ(bytes, captures[0].message.size());
  EXPECT_EQ(ListSlots(), (std::vector<int>{1, 0, 2}));
  EXPECT_EQ(sent.front().offset, captures[1].message.size());
}

TEST_F(DownloadTest, BeginsABlueprintAnewThatChangesOnItsWay) {
  download.Begin(0, 3, 0, {});
  SendDue();
  ASSERT_EQ(sent.back().slot, 1);  // the window ended within it
  download.Renew(1);
  download.Renew(2);  // has not begun: stays one
  download.Renew(0);  // is done: again
  sent.clear();
  while (!download.IsDone()) {
    ASSERT_TRUE(download.TakeReport(bytes));
    SendDue();
  }
  EXPECT_EQ(ListSlots(), (std::vector<int>{1, 2, 0}));
  EXPECT_EQ(sent.front().offset, 0U);
}

TEST_F(DownloadTest, KnowsWhichBlueprintsHaveArrived) {
  using Stage = Download::Stage;
  const std::uint64_t kept[] = {captures[1].hash};
  download.Begin(0, 3, 1, kept);
  EXPECT_EQ(download.Find(1), Stage::kUnsent);
  SendDue();
  EXPECT_EQ(download.Find(1), Stage::kOnTheWay) << "a kept one, too: the piece that says so may be lost";
  EXPECT_EQ(download.Find(0), Stage::kOnTheWay);
  EXPECT_EQ(download.Find(2), Stage::kUnsent);
  const auto first = static_cast<std::uint32_t>(captures[0].message.size());
  ASSERT_TRUE(download.TakeReport(protocol::kKeptPieceBytes + first - 1));
  EXPECT_EQ(download.Find(1), Stage::kArrived);
  EXPECT_EQ(download.Find(0), Stage::kOnTheWay);
  ASSERT_TRUE(download.TakeReport(protocol::kKeptPieceBytes + first));
  EXPECT_EQ(download.Find(0), Stage::kArrived);
  SendDue();
  EXPECT_EQ(download.Find(2), Stage::kOnTheWay);
  download.Renew(2);
  EXPECT_EQ(download.Find(2), Stage::kUnsent);
  ASSERT_TRUE(download.TakeReport(protocol::kKeptPieceBytes + bytes));
  EXPECT_EQ(download.Find(2), Stage::kUnsent) << "what has arrived is the one before";
  download.Renew(0);
  EXPECT_EQ(download.Find(0), Stage::kUnsent);
}

TEST_F(DownloadTest, RefusesAReportOfWhatWasNeverSent) {
  EXPECT_TRUE(download.TakeReport(0));
  EXPECT_FALSE(download.TakeReport(1));
  download.Begin(0, 3, 0, {});
  SendDue();
  EXPECT_TRUE(download.TakeReport(bytes));
  EXPECT_FALSE(download.TakeReport(bytes + 1));
  EXPECT_FALSE(download.TakeReport(0x80000000U + bytes));
}

TEST_F(DownloadTest, AnotherSceneTakesThePlaceOfWhatWasQueuedAndCountsOn) {
  download.Begin(0, 3, 1, {});
  SendDue();
  const std::uint32_t before = bytes;
  EXPECT_TRUE(download.TakeReport(before / 2));
  EXPECT_TRUE(download.IsOfThisScene(before / 2));
  sent.clear();
  download.Begin(0, 2, 0, {});
  EXPECT_FALSE(download.IsOfThisScene(before)) << "all that was sent of the scene before";
  EXPECT_EQ(download.Find(1), Download::Stage::kUnsent);
  for (std::uint32_t taken = before; !download.IsDone(); taken = bytes) {
    EXPECT_TRUE(download.TakeReport(taken));
    SendDue();
  }
  EXPECT_EQ(ListSlots(), (std::vector<int>{0, 1}));
  EXPECT_EQ(sent.front().offset, 0U);
  EXPECT_TRUE(download.IsOfThisScene(before + 1));
  EXPECT_TRUE(download.TakeReport(bytes));
  EXPECT_EQ(download.Find(0), Download::Stage::kArrived);
  EXPECT_TRUE(download.TakeReport(before)) << "an input of the scene before comes late";
}

}  // namespace
}  // namespace wobble::server
