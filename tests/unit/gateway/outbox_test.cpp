#include <gtest/gtest.h>

#include "client/gateway/outbox.h"

namespace wobble::gateway {
namespace {

constexpr std::uint8_t kControl = 0;
constexpr std::uint8_t kSnapshot = 2;

std::vector<std::uint8_t> MakeMessage(std::size_t bytes, std::uint8_t content) {
  return std::vector<std::uint8_t>(bytes, content);
}

TEST(Outbox, KeepsTheOrder) {
  Outbox outbox;
  outbox.Add(kSnapshot, MakeMessage(2, 7));
  outbox.Add(kControl, MakeMessage(1, 8));
  outbox.Add(kSnapshot, {});
  EXPECT_EQ(outbox.Take(), (Outbox::Message{kSnapshot, 7, 7}));
  EXPECT_EQ(outbox.Take(), (Outbox::Message{kControl, 8}));
  EXPECT_EQ(outbox.Take(), (Outbox::Message{kSnapshot}));
  EXPECT_TRUE(outbox.IsEmpty());
  EXPECT_EQ(outbox.CountDropped(), 0U);
}

TEST(Outbox, DropsTheOldestSnapshotsAndNothingElse) {
  Outbox outbox;
  constexpr std::size_t kBytes = 1023;  // and a byte for the channel
  constexpr std::size_t kMost = kMaxWaitingSnapshotBytes / 1024;
  for (std::size_t i = 0; i < kMost + 10; ++i) {
    outbox.Add(kControl, MakeMessage(kBytes, static_cast<std::uint8_t>(i)));
    outbox.Add(kSnapshot, MakeMessage(kBytes, static_cast<std::uint8_t>(i)));
  }
  EXPECT_EQ(outbox.CountDropped(), 10U);
  std::vector<std::uint8_t> controls, snapshots;
  while (!outbox.IsEmpty()) {
    const Outbox::Message message = outbox.Take();
    (message[0] == kControl ? controls : snapshots).push_back(message[1]);
  }
  ASSERT_EQ(controls.size(), kMost + 10);
  ASSERT_EQ(snapshots.size(), kMost);
  EXPECT_EQ(controls.front(), 0);
  EXPECT_EQ(snapshots.front(), 10);
  EXPECT_EQ(snapshots.back(), kMost + 9);
}

TEST(Outbox, IsOverfullWithWhatMayNotBeDropped) {
  Outbox outbox;
  for (int i = 0; i < 64; ++i) outbox.Add(kControl, MakeMessage(64 * 1024 - 1, 0));
  EXPECT_FALSE(outbox.IsOverfull());
  outbox.Add(kSnapshot, MakeMessage(1, 0));
  EXPECT_TRUE(outbox.IsOverfull());
  static_cast<void>(outbox.Take());
  EXPECT_FALSE(outbox.IsOverfull());
  outbox.Clear();
  EXPECT_TRUE(outbox.IsEmpty());
}

}  // namespace
}  // namespace wobble::gateway
