// What of ENet's commands a client may send.
#include "protocol/transport/vestibule/command_filter.h"

#include <gtest/gtest.h>

#include "tests/unit/vestibule/deterministic.h"

namespace wobble::transport::vestibule {
namespace {

using Verdict = CommandFilter::Verdict;

class CommandFilterTest : public testing::Test {
 protected:
  void Connect() { ASSERT_EQ(filter.Judge(MakeConnect(77)), Verdict::kPass); }
  CommandFilter filter;
};

// A datagram without time and of these commands.
Bytes MakeDatagram(const Bytes& commands) {
  Bytes bytes(6);
  bytes.insert(bytes.end(), commands.begin(), commands.end());
  return bytes;
}

TEST_F(CommandFilterTest, BeginsWithOneConnectAndNoOther) {
  EXPECT_EQ(filter.Judge(MakeReliable(1, 10)), Verdict::kDrop) << "before the connect: perhaps overtaken";
  EXPECT_FALSE(filter.ConnectionNumber());
  EXPECT_EQ(filter.Judge(MakeConnect(0)), Verdict::kOffence);
  Connect();
  EXPECT_EQ(filter.ConnectionNumber(), 77U);
  EXPECT_EQ(filter.Judge(MakeConnect(77)), Verdict::kPass) << "again, because it was lost";
  EXPECT_EQ(filter.Judge(MakeConnect(78)), Verdict::kOffence);
}

TEST_F(CommandFilterTest, PassesWhatHonestClientsSend) {
  Connect();
  EXPECT_EQ(filter.Judge(MakeReliable(1, 10)), Verdict::kPass);
  EXPECT_EQ(filter.Judge(MakeDatagram({0x05, 0xFF, 0, 2})), Verdict::kPass) << "ping";
  EXPECT_EQ(filter.Judge(MakeDatagram({0x01, 0, 0, 1, 0, 1, 0, 9})), Verdict::kPass) << "acknowledgement";
  EXPECT_EQ(filter.Judge(MakeDatagram({0x49, 1, 0, 0, 0, 7, 0, 3, 1, 2, 3})), Verdict::kPass) << "input";
  EXPECT_EQ(filter.Judge(MakeDatagram({0x44, 0xFF, 0, 0, 0, 0, 0, 0})), Verdict::kPass) << "disconnect";
}

TEST_F(CommandFilterTest, RefusesFragmentsAndUnsequencedLies) {
  Connect();
  Bytes fragment{0x88, 0, 0, 1, 0, 1, 0, 4};
  fragment.resize(24 + 4);
  EXPECT_EQ(filter.Judge(MakeDatagram(fragment)), Verdict::kOffence);
  EXPECT_EQ(filter.Judge(MakeDatagram({0x07, 1, 0, 0, 0, 1, 0, 1, 5})), Verdict::kOffence) << "unreliable";
  EXPECT_EQ(filter.Judge(MakeReliable(1, 0)), Verdict::kOffence) << "empty";
  EXPECT_EQ(filter.Judge(MakeReliable(1, 10, 2)), Verdict::kOffence) << "on the snapshots' channel";
  EXPECT_EQ(filter.Judge(MakeDatagram({0x49, 0, 0, 0, 0, 7, 0, 3, 1, 2, 3})), Verdict::kOffence) << "on control";
  EXPECT_EQ(filter.Judge(MakeDatagram({0x49, 1, 0, 0, 0, 7, 0, 9, 1, 2, 3})), Verdict::kOffence) << "longer than it is";
}

TEST_F(CommandFilterTest, RefusesWhatIsNoDatagram) {
  for (const Bytes& bytes : {Bytes{}, Bytes{0}, Bytes(6), Bytes{0x40, 0, 0, 0, 0, 0, 5, 0xFF, 0, 1}}) {
    EXPECT_EQ(filter.Judge(bytes), Verdict::kOffence);
  }
  Connect();
  Bytes many;
  for (std::size_t i = 0; i <= kMaxCommands; ++i) many.insert(many.end(), {0x05, 0xFF, 0, 2});
  EXPECT_EQ(filter.Judge(MakeDatagram(many)), Verdict::kOffence);
  many.resize(4 * kMaxCommands);
  EXPECT_EQ(filter.Judge(MakeDatagram(many)), Verdict::kPass);
}

TEST_F(CommandFilterTest, ReliableNumbersStayWithinTheWindow) {
  Connect();
  EXPECT_EQ(filter.Judge(MakeReliable(static_cast<std::uint16_t>(kReliableWindow), 1)), Verdict::kPass)
      << "the last in the window";
  EXPECT_EQ(filter.Judge(MakeReliable(static_cast<std::uint16_t>(kReliableWindow + 1), 1)), Verdict::kOffence);
  // In order it goes on past the wrap of 16 bits, and what came comes again.
  for (unsigned number = 1; number < 70'000; ++number) {
    ASSERT_EQ(filter.Judge(MakeReliable(static_cast<std::uint16_t>(number), 1)), Verdict::kPass) << number;
    ASSERT_EQ(filter.Judge(MakeReliable(static_cast<std::uint16_t>(number), 1)), Verdict::kPass) << number;
  }
}

// Any bytes: a verdict, and no access outside of them (the sanitized build tells).
TEST_F(CommandFilterTest, AnyBytesGetAVerdict) {
  std::mt19937 random(11);
  Connect();
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes(random() % 80);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    CommandFilter copy = filter;
    static_cast<void>(copy.Judge(bytes));
  }
}

}  // namespace
}  // namespace wobble::transport::vestibule
