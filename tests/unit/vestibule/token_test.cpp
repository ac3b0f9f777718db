// Secrets as text: each has one text, and every other text is refused.
#include "protocol/transport/vestibule/token.h"

#include <gtest/gtest.h>

#include <string_view>

#include "tests/unit/vestibule/deterministic.h"

namespace wobble::transport::vestibule {
namespace {

TEST(SecretText, IsReadAsItWasWritten) {
  for (std::size_t size = 1; size <= 64; ++size) {
    Bytes secret(size);
    MakeRandom(size)(secret);
    EXPECT_EQ(ParseSecret(FormatSecret(secret)), secret);
  }
}

TEST(SecretText, EveryOtherTextIsRefused) {
  using namespace std::string_view_literals;
  // Nothing, a length that no secret has, padding, the other alphabet, a blank, a NUL, bits that are left over, and a
  // byte that libsodium takes for '_' (fuzzing found it).
  for (const std::string_view text :
       {""sv, "A"sv, "AAAAA"sv, "AAA="sv, "++//"sv, "AA A"sv, "AAA\0"sv, "AB"sv, "AAA\xff"sv})
    EXPECT_EQ(ParseSecret(text), std::nullopt) << text;
  EXPECT_EQ(ParseSecret({}), std::nullopt);
}

}  // namespace
}  // namespace wobble::transport::vestibule
