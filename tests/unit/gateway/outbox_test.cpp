#include <gtest/gtest.h>

#include "client/gateway/outbox.h"

namespace wobble::gateway {
namespace {

constexpr std::uint8_t kControl = 0;
constexpr std::uint8_t kSnapshot = 2;

std::vector<std::uint8_t> MakeMessage(std::size_t bytes, std::uint8_t content) {
  return std::vector<std::uint8_t>(bytes, content);
}

TEST(Outbox, KeepsTheOrderOfEachKind) {
  Outbox outbox;
  outbox.AddSnapshot(MakeMessage(2, 7), 0);
  outbox.Add(kControl, MakeMessage(1, 8));
  outbox.AddSnapshot({}, 0);
  EXPECT_EQ(outbox.Take(), (Outbox::Message{kSnapshot, 7, 7}));
  EXPECT_EQ(outbox.Take(), (Outbox::Message{kControl, 8}));
  EXPECT_EQ(outbox.Take(), (Outbox::Message{kSnapshot}));
  EXPECT_TRUE(outbox.IsEmpty());
  EXPECT_EQ(outbox.CountDropped(), 0U);
}

TEST(Outbox, ADownloadAndThePictureLeaveInTurn) {
  Outbox outbox;
  for (std::uint8_t i = 0; i < 3; ++i) outbox.Add(kControl, MakeMessage(1, i));
  for (std::uint8_t i = 0; i < 2; ++i) outbox.AddSnapshot(MakeMessage(1, i), 0);
  std::vector<Outbox::Message> taken;
  while (!outbox.IsEmpty()) taken.push_back(outbox.Take());
  const std::vector<Outbox::Message> expected{
      {kSnapshot, 0}, {kControl, 0}, {kSnapshot, 1}, {kControl, 1}, {kControl, 2}};
  EXPECT_EQ(taken, expected);
}

TEST(Outbox, DropsSnapshotsThatHaveWaitedTooLongAndNothingElse) {
  Outbox outbox;
  for (std::uint8_t i = 0; i < 20; ++i) {
    outbox.Add(kControl, MakeMessage(1, i));
    outbox.AddSnapshot(MakeMessage(1, i), 0.02 * i);
  }
  outbox.DropLate(0.4);  // what is older than 0.25: 0 to 12
  EXPECT_EQ(outbox.CountDropped(), 13U);
  EXPECT_EQ(outbox.TakeSnapshot(), (Outbox::Message{kSnapshot, 13}));
  std::size_t controls = 0;
  while (!outbox.IsEmpty()) controls += outbox.Take()[0] == kControl ? 1 : 0;
  EXPECT_EQ(controls, 20U);
}

// A snapshot of a large world is larger than what a slow line carries in a second.
TEST(Outbox, DropsNothingOfALargeSnapshotThatHasJustCome) {
  Outbox outbox;
  for (int i = 0; i < 200; ++i) outbox.AddSnapshot(MakeMessage(1100, 1), 5);
  outbox.DropLate(5.1);
  EXPECT_EQ(outbox.CountDropped(), 0U);
}

TEST(Outbox, IsOverfullWithWhatMayNotBeDropped) {
  Outbox outbox;
  for (int i = 0; i < 64; ++i) outbox.Add(kControl, MakeMessage(64 * 1024 - 1, 0));
  EXPECT_FALSE(outbox.IsOverfull());
  outbox.Add(kControl, MakeMessage(1, 0));
  EXPECT_TRUE(outbox.IsOverfull());
  static_cast<void>(outbox.Take());
  EXPECT_FALSE(outbox.IsOverfull());
  outbox.Clear();
  EXPECT_TRUE(outbox.IsEmpty());
}

}  // namespace
}  // namespace wobble::gateway
