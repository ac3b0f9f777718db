// ICU has the tables of Unicode and is kept up with it. It is used by its C functions, whose interface does not change
// with its version, and by the server alone: what clients show is filtered by protocol/text.h, which has no tables.
//
// Names are not checked for mixed scripts: "Ada в Риме" is an honest name, and a look-alike of a present player's name
// is found by its skeleton, whatever its script. Two names that differ in capitals do not look alike.
#include "server/names.h"

#include <unicode/uchar.h>
#include <unicode/unorm2.h>
#include <unicode/uspoof.h>
#include <unicode/ustring.h>

#include <memory>
#include <set>

#include "protocol/limits.h"
#include "protocol/text.h"

namespace wobble::server {
namespace {

constexpr const char* kNameOfNobody = "player";
constexpr char16_t kBrailleBlank = 0x2800;  // a symbol for Unicode, and a space for the eye
// NFKC makes at most so many UTF-16 units of one; a skeleton is shorter.
constexpr std::size_t kMostGrowth = 18;

// The text in UTF-16 and back. `text` is valid UTF-8.
std::u16string ToUnits(std::string_view text) {
  std::u16string units(text.size(), u'\0');
  std::int32_t length = 0;
  UErrorCode status = U_ZERO_ERROR;
  u_strFromUTF8(units.data(), static_cast<std::int32_t>(units.size()), &length, text.data(),
                static_cast<std::int32_t>(text.size()), &status);
  units.resize(U_SUCCESS(status) ? static_cast<std::size_t>(length) : 0);
  return units;
}

std::string ToBytes(std::u16string_view units) {
  std::string text(3 * units.size() + 1, '\0');
  std::int32_t length = 0;
  UErrorCode status = U_ZERO_ERROR;
  u_strToUTF8(text.data(), static_cast<std::int32_t>(text.size()), &length, units.data(),
              static_cast<std::int32_t>(units.size()), &status);
  text.resize(U_SUCCESS(status) ? static_cast<std::size_t>(length) : 0);
  return text;
}

// Empty when ICU fails, which it does only without memory or without its data: the name is then refused as empty.
std::u16string Normalise(std::u16string_view units) {
  UErrorCode status = U_ZERO_ERROR;
  const UNormalizer2* form = unorm2_getNFKCInstance(&status);
  std::u16string normal(kMostGrowth * units.size(), u'\0');
  const std::int32_t length = unorm2_normalize(form, units.data(), static_cast<std::int32_t>(units.size()),
                                               normal.data(), static_cast<std::int32_t>(normal.size()), &status);
  normal.resize(U_SUCCESS(status) ? static_cast<std::size_t>(length) : 0);
  return normal;
}

// Leaves out what shows nothing, and joins runs of spaces into one; none at the ends.
std::u16string DropInvisible(std::u16string_view units) {
  std::u16string visible;
  bool isApart = false;
  for (std::size_t at = 0; at < units.size();) {
    const std::size_t begin = at;
    UChar32 codePoint = 0;
    U16_NEXT(units, at, units.size(), codePoint);
    if (u_hasBinaryProperty(codePoint, UCHAR_DEFAULT_IGNORABLE_CODE_POINT)) continue;
    if (u_isUWhiteSpace(codePoint) || codePoint == kBrailleBlank) {
      isApart = true;
      continue;
    }
    if (isApart && !visible.empty()) visible += u' ';
    isApart = false;
    visible += units.substr(begin, at - begin);
  }
  return visible;
}

// `text` without spaces at its end, cut to maxBytes between code points.
std::string Fit(const std::string& text, std::size_t maxBytes) {
  std::string cut = protocol::MakeLine(text, maxBytes);
  while (!cut.empty() && cut.back() == ' ') cut.pop_back();
  return cut;
}

// What the eye sees of a name: equal for names that look alike. The name itself when ICU fails.
std::string FindSkeleton(std::string_view name) {
  struct Close {
    void operator()(USpoofChecker* checker) const { uspoof_close(checker); }
  };
  // It reads ICU's data and never changes; opened once, because that takes two milliseconds, a skeleton two
  // microseconds.
  static const std::unique_ptr<USpoofChecker, Close> kChecker = [] {
    UErrorCode status = U_ZERO_ERROR;
    return std::unique_ptr<USpoofChecker, Close>(uspoof_open(&status));
  }();
  UErrorCode status = U_ZERO_ERROR;
  char skeleton[3 * kMostGrowth * protocol::kMaxNameBytes];
  const std::int32_t length = uspoof_getSkeletonUTF8(
      kChecker.get(), 0, name.data(), static_cast<std::int32_t>(name.size()), skeleton, sizeof skeleton, &status);
  return U_SUCCESS(status) ? std::string(skeleton, static_cast<std::size_t>(length)) : std::string(name);
}

}  // namespace

std::string CleanText(std::string_view bytes, std::size_t maxBytes) {
  const std::string line = protocol::MakeLine(bytes, maxBytes);
  // Composition may join what was left apart, so the second round sees what the first has made.
  const std::u16string visible = DropInvisible(Normalise(DropInvisible(ToUnits(line))));
  return Fit(ToBytes(visible), maxBytes);
}

std::string CleanName(std::string_view bytes) {
  const std::string name = CleanText(bytes, protocol::kMaxNameBytes);
  return name.empty() ? kNameOfNobody : name;
}

std::string MakeDistinct(const std::string& name, std::span<const std::string_view> taken) {
  std::set<std::string> skeletons;
  for (const std::string_view other : taken) skeletons.insert(FindSkeleton(other));
  std::string distinct = name;
  for (std::size_t number = 2; skeletons.contains(FindSkeleton(distinct)); ++number) {
    const std::string suffix = " " + std::to_string(number);
    distinct = Fit(name, protocol::kMaxNameBytes - suffix.size()) + suffix;
  }
  return distinct;
}

}  // namespace wobble::server
