// The ranges of format characters are those of Unicode 15 (DerivedGeneralCategory.txt), each widened to the unassigned
// code points inside it. A test compares them with the server's Unicode library for all code points; that library is
// not used here, because its tables are as large as everything that a browser downloads.
#include "protocol/text.h"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace wobble::protocol {
namespace {

struct CodePointRange {
  char32_t first, last;
};
constexpr CodePointRange kFormatCharacters[] = {
    {0xAD, 0xAD},       {0x600, 0x605},     {0x61C, 0x61C},     {0x6DD, 0x6DD},     {0x70F, 0x70F},
    {0x890, 0x891},     {0x8E2, 0x8E2},     {0x180E, 0x180E},   {0x200B, 0x200F},   {0x202A, 0x202E},
    {0x2060, 0x206F},   {0xFEFF, 0xFEFF},   {0xFFF9, 0xFFFB},   {0x110BD, 0x110BD}, {0x110CD, 0x110CD},
    {0x13430, 0x1343F}, {0x1BCA0, 0x1BCA3}, {0x1D173, 0x1D17A}, {0xE0001, 0xE007F}};

bool IsFormatCharacter(char32_t codePoint) {
  return std::any_of(std::begin(kFormatCharacters), std::end(kFormatCharacters),
                     [&](const CodePointRange& range) { return codePoint >= range.first && codePoint <= range.last; });
}

bool BreaksLine(char32_t codePoint) {
  return codePoint < 0x20 || (codePoint >= 0x7F && codePoint < 0xA0) || codePoint == 0x2028 || codePoint == 0x2029;
}

// The number of bytes of the well-formed sequence at the beginning of `text`, and its code point; 0: there is none. The
// bounds of the second byte exclude overlong forms, surrogates and what is above U+10FFFF (Unicode, table 3-7).
std::size_t ReadSequence(std::string_view text, char32_t& codePoint) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = byte(0);
  codePoint = lead;
  if (lead < 0x80) return 1;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (text.size() < length) return 0;
  const std::uint8_t low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const std::uint8_t high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (byte(1) < low || byte(1) > high) return 0;
  codePoint = lead & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
    codePoint = codePoint << 6U | (byte(i) & 0x3FU);
  }
  return length;
}

}  // namespace

std::string MakeLine(std::string_view text, std::size_t maxBytes) {
  std::string line;
  while (!text.empty()) {
    char32_t codePoint = 0;
    const std::size_t length = ReadSequence(text, codePoint);
    std::string_view shown = length == 0 ? "\xEF\xBF\xBD" : text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
    if (length > 0 && IsFormatCharacter(codePoint)) continue;
    if (length > 0 && BreaksLine(codePoint)) shown = " ";
    if (line.size() + shown.size() > maxBytes) break;
    line += shown;
  }
  return line;
}

}  // namespace wobble::protocol
