// Text from the wire: whatever the bytes, what comes out is one short line of valid UTF-8 that a terminal only shows.
#include "protocol/text.h"

#include <gtest/gtest.h>

#include "protocol/random.h"

namespace wobble::protocol {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";

std::string Repeat(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(Text, WhatIsGoodStaysAsItIs) {
  for (const char* text : {"", "Ada", "name with spaces", "Grüße, Zoë", "Ольга", "名前", "🙂 a\xCC\x81"}) {
    EXPECT_EQ(MakeLine(text, 64), text);
  }
}

TEST(Text, ControlCharactersAndLineBreaksBecomeSpaces) {
  EXPECT_EQ(MakeLine(std::string_view("a\0b\x1b[2J\r\n\x7f"
                                      "c",
                                      11),
                     64),
            "a b [2J   c");
  EXPECT_EQ(MakeLine("a\xC2\x9B"
                     "31mb\xC2\x85"
                     "c",
                     64),
            "a 31mb c");  // C1: CSI and NEL
  EXPECT_EQ(MakeLine("a\xE2\x80\xA8"
                     "b\xE2\x80\xA9"
                     "c",
                     64),
            "a b c");  // U+2028, U+2029
}

TEST(Text, BidiAndInvisibleFormatCharactersAreLeftOut) {
  EXPECT_EQ(MakeLine("a\xE2\x80\xAE"
                     "b\xE2\x81\xA6"
                     "c\xE2\x81\xA9\xE2\x80\x8F\xD8\x9C",
                     64),
            "abc");
  EXPECT_EQ(MakeLine("a\xE2\x80\x8B\xE2\x80\x8D\xEF\xBB\xBF\xC2\xAD\xF3\xA0\x81\x81"
                     "b",
                     64),
            "ab");
}

TEST(Text, WhatIsNoUtf8IsReplacedByteByByte) {
  struct Case {
    std::string_view bytes;
    int bad;
  };
  for (const Case& each : {Case{"\x80", 1},              // a continuation without a beginning
                           Case{"\xC0\xAF", 2},          // overlong '/'
                           Case{"\xC1\xBF", 2},          //
                           Case{"\xE0\x80\xAF", 3},      // overlong in three bytes
                           Case{"\xF0\x82\x82\xAC", 4},  // and in four
                           Case{"\xED\xA0\x80", 3},      // a surrogate
                           Case{"\xED\xBF\xBF", 3},      //
                           Case{"\xF4\x90\x80\x80", 4},  // above U+10FFFF
                           Case{"\xF5\x80\x80\x80", 4},  //
                           Case{"\xFE\xFF", 2},          //
                           Case{"\xC3", 1},              // cut off
                           Case{"\xE2\x82", 2},          //
                           Case{"\xF0\x9F\x99", 3}}) {
    const std::string bad = Repeat(kReplacement, each.bad);
    EXPECT_EQ(MakeLine(each.bytes, 64), bad) << each.bad;
    EXPECT_EQ(MakeLine(std::string(each.bytes) + "x", 64), bad + "x");
  }
  EXPECT_EQ(MakeLine("\x9B"
                     "31m",
                     64),
            kReplacement + std::string("31m"));  // C1 as a byte of Latin-1
}

TEST(Text, IsCutBetweenCharacters) {
  EXPECT_EQ(MakeLine("abcdef", 3), "abc");
  EXPECT_EQ(MakeLine("abcdef", 0), "");
  const std::string longest = Repeat("a", 30) + "\xC3\xA9";
  EXPECT_EQ(MakeLine(longest, 32), longest);
  EXPECT_EQ(MakeLine(longest, 31), Repeat("a", 30));
  EXPECT_EQ(MakeLine(Repeat("a", 29) + "\xF0\x9F\x99\x82"
                                       "b",
                     32),
            Repeat("a", 29));
  EXPECT_EQ(MakeLine(Repeat("a", 31) + "\xFF", 32), Repeat("a", 31));  // its replacement would not fit
}

// Whether the well-formed text has none of what a line must not have; reads it in another way than MakeLine does.
void ExpectShowable(const std::string& line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto byte = static_cast<unsigned char>(line[i]);
    ASSERT_TRUE(byte >= 0x20 && byte != 0x7F);
    if (byte < 0x80) continue;
    const std::size_t more = byte >= 0xF0 ? 3 : byte >= 0xE0 ? 2 : 1;
    ASSERT_TRUE(byte >= 0xC2 && byte <= 0xF4 && i + more < line.size());
    for (std::size_t k = 1; k <= more; ++k) ASSERT_EQ(static_cast<unsigned char>(line[i + k]) & 0xC0, 0x80);
    const auto next = static_cast<unsigned char>(line[i + 1]);
    ASSERT_FALSE(byte == 0xC2 && next < 0xA0);  // C1
    ASSERT_FALSE(byte == 0xED && next >= 0xA0);
    i += more;
  }
}

TEST(Text, AnyBytesBecomeAShowableLine) {
  Random random(7);
  // Bytes that begin and continue what is to be found, more often than chance would bring them together.
  constexpr std::string_view kTelling = "\xC2\x9B\xE2\x80\xAE\xED\xA0\xF0\x9F\xF4\x90\xEF\xBB\xBF\x1b a";
  for (int round = 0; round < 20000; ++round) {
    std::string bytes;
    for (std::uint64_t left = random.Next() % 40; left > 0; --left) {
      const std::uint64_t chance = random.Next();
      bytes += (chance & 256) != 0 ? static_cast<char>(chance) : kTelling[chance % kTelling.size()];
    }
    const std::size_t most = random.Next() % 40;
    const std::string line = MakeLine(bytes, most);
    ASSERT_LE(line.size(), most);
    ExpectShowable(line);
    ASSERT_EQ(MakeLine(line, most), line);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace wobble::protocol
