// Names: any bytes become a name that can be shown, and no two players' names look alike.
#include "server/names.h"

#include <gtest/gtest.h>
#include <unicode/uchar.h>
#include <unicode/unorm2.h>
#include <unicode/ustring.h>

#include <set>
#include <string>
#include <vector>

#include "protocol/limits.h"
#include "protocol/random.h"
#include "protocol/text.h"

namespace wobble::server {
namespace {

std::string Encode(char32_t codePoint) {
  std::string bytes(U8_MAX_LENGTH, '\0');
  std::size_t length = 0;
  U8_APPEND_UNSAFE(bytes.data(), length, codePoint);
  bytes.resize(length);
  return bytes;
}

std::string Distinguish(const std::string& name, const std::vector<std::string>& present) {
  const std::vector<std::string_view> taken(present.begin(), present.end());
  return MakeDistinct(name, taken);
}

TEST(Names, AreInOneSpellingWithoutWhatCannotBeSeen) {
  EXPECT_EQ(CleanName("Ada"), "Ada");
  EXPECT_EQ(CleanName("Ольга 名前 🙂"), "Ольга 名前 🙂");
  EXPECT_EQ(CleanName("Zoe\xCC\x88"), "Zo\xC3\xAB");                    // composed
  EXPECT_EQ(CleanName("\xEF\xBC\xA1\xEF\xBD\x84\xEF\xBD\x81"), "Ada");  // full-width
  EXPECT_EQ(CleanName("\xEF\xAC\x81sh"), "fish");                       // a ligature
  EXPECT_EQ(CleanName("A\xC2\xA0 \xE3\x80\x80"
                      "da  "),
            "A da");  // spaces of other kinds
  EXPECT_EQ(CleanName("A\xE2\x80\xAE"
                      "d\xE2\x80\x8B"
                      "a\xEF\xB8\x8F"),
            "Ada");
  EXPECT_EQ(CleanName("A\x1b[2J\n\xC2\x9B"
                      "1m"),
            "A [2J 1m");
  EXPECT_EQ(CleanName("Z\xF6"
                      "e"),
            "Z\xEF\xBF\xBD"
            "e");  // Latin-1
}

TEST(Names, NothingLeftIsPlayer) {
  for (const char* name : {"", " ", "\n\t", "\xE2\x80\x8B", "\xE3\x85\xA4", "\xE2\xA0\x80", "\xF3\xA0\x81\x81"}) {
    EXPECT_EQ(CleanName(name), "player") << name;
  }
}

TEST(Names, FitIn32BytesOfWholeCharacters) {
  EXPECT_EQ(CleanName(std::string(40, 'x')), std::string(32, 'x'));
  EXPECT_EQ(CleanName(std::string(30, 'x') + "\xE5\x90\x8D"), std::string(30, 'x'));
  EXPECT_EQ(CleanName(std::string(29, 'x') + "\xE5\x90\x8D"), std::string(29, 'x') + "\xE5\x90\x8D");
  // NFKC makes 33 bytes of the one character U+FDFA.
  const std::string grown = CleanName("\xEF\xB7\xBA");
  EXPECT_LE(grown.size(), 32U);
  EXPECT_GE(grown.size(), 30U);
}

TEST(Names, LookAlikesOfThePresentGetANumber) {
  EXPECT_EQ(Distinguish("Ada", {}), "Ada");
  EXPECT_EQ(Distinguish("Ada", {"Eve"}), "Ada");
  EXPECT_EQ(Distinguish("Ada", {"Ada"}), "Ada 2");
  EXPECT_EQ(Distinguish("Ada", {"Ada", "Ada 2", "Ada 3"}), "Ada 4");
  EXPECT_EQ(Distinguish("\xD0\x90"
                        "d\xD0\xB0",
                        {"Ada"}),
            "\xD0\x90"
            "d\xD0\xB0 2");  // Cyrillic А and а
  EXPECT_EQ(Distinguish("paypal", {"\xD1\x80\xD0\xB0\xD1\x83\xD1\x80\xD0\xB0l"}), "paypal 2");
  EXPECT_EQ(Distinguish("rnodern", {"modern"}), "rnodern 2");
  EXPECT_EQ(Distinguish("l1I", {"Il1"}), "l1I 2");
  EXPECT_EQ(Distinguish("ADA", {"Ada"}), "ADA");
}

TEST(Names, TheNumberFitsWithoutCuttingACharacter) {
  const std::string longest(32, 'x');
  EXPECT_EQ(Distinguish(longest, {longest}), std::string(30, 'x') + " 2");
  const std::string wide = std::string(29, 'x') + "\xE5\x90\x8D";
  EXPECT_EQ(Distinguish(wide, {wide}), std::string(29, 'x') + " 2");
  EXPECT_EQ(Distinguish(std::string(29, 'x') + " yz", {std::string(29, 'x') + " yz"}), std::string(29, 'x') + " 2");

  std::vector<std::string> present;
  for (int i = 0; i < 120; ++i) present.push_back(Distinguish(longest, present));
  EXPECT_EQ(present.back(), std::string(28, 'x') + " 120");
  EXPECT_EQ(std::set<std::string>(present.begin(), present.end()).size(), present.size());
}

TEST(Names, AnyBytesBecomeAGoodName) {
  UErrorCode status = U_ZERO_ERROR;
  const UNormalizer2* form = unorm2_getNFKCInstance(&status);
  protocol::Random random(11);
  for (int round = 0; round < 20000; ++round) {
    std::string bytes;
    while (bytes.size() < 40 && random.Next() % 12 != 0) {
      const std::uint64_t chance = random.Next();
      const auto codePoint = static_cast<char32_t>((chance >> 8) % (chance % 3 == 0 ? 0x110000 : 0x3000));
      bytes += chance % 7 == 0 ? std::string(1, static_cast<char>(chance >> 8)) : Encode(codePoint);
    }
    const std::string name = CleanName(bytes);
    ASSERT_TRUE(!name.empty() && name.size() <= protocol::kMaxNameBytes);
    ASSERT_EQ(protocol::MakeLine(name, 64), name);
    ASSERT_TRUE(name.front() != ' ' && name.back() != ' ' && name.find("  ") == std::string::npos);
    char16_t units[64];
    std::int32_t length = 0;
    u_strFromUTF8(units, 64, &length, name.data(), static_cast<std::int32_t>(name.size()), &status);
    ASSERT_TRUE(U_SUCCESS(status)) << testing::PrintToString(bytes);
    ASSERT_TRUE(unorm2_isNormalized(form, units, length, &status)) << testing::PrintToString(bytes);
    ASSERT_EQ(CleanName(name), name) << testing::PrintToString(bytes);
    ASSERT_NE(Distinguish(name, {name}), name);
    ASSERT_LE(Distinguish(name, {name}).size(), protocol::kMaxNameBytes);
  }
}

// The table of protocol/text.cpp against Unicode's.
TEST(Names, TheProtocolKnowsAllControlAndFormatCharacters) {
  for (char32_t codePoint = 0; codePoint <= 0x10FFFF; ++codePoint) {
    if (U_IS_SURROGATE(codePoint)) continue;
    const std::string text = Encode(codePoint);
    const std::string line = protocol::MakeLine(text, 8);
    switch (u_charType(static_cast<UChar32>(codePoint))) {
      case U_CONTROL_CHAR:
      case U_LINE_SEPARATOR:
      case U_PARAGRAPH_SEPARATOR:
        ASSERT_EQ(line, " ") << static_cast<unsigned>(codePoint);
        break;
      case U_FORMAT_CHAR:
        ASSERT_EQ(line, "") << static_cast<unsigned>(codePoint);
        break;
      case U_UNASSIGNED:
        ASSERT_TRUE(line.empty() || line == text) << static_cast<unsigned>(codePoint);
        break;
      default:
        ASSERT_EQ(line, text) << static_cast<unsigned>(codePoint);
    }
  }
}

}  // namespace
}  // namespace wobble::server
