#include "protocol/usage/likeness.h"

#include <algorithm>
#include <vector>

namespace wobble::usage {
namespace {

constexpr std::size_t kMostLetters = 64;

}  // namespace

std::size_t CountEdits(std::string_view a, std::string_view b) {
  // Rows of the table of prefixes: the last two and the present one.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool isSwapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (isSwapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::string FindLikest(std::string_view word, std::span<const std::string> known) {
  if (word.size() > kMostLetters) return "";
  const std::string* likest = nullptr;
  std::size_t fewest = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& each : known) {
    const std::size_t edits = each.size() > kMostLetters ? fewest : CountEdits(word, each);
    if (edits >= fewest) continue;
    fewest = edits;
    likest = &each;
  }
  return likest == nullptr ? "" : *likest;
}

std::string Suggest(std::string_view word, std::span<const std::string> known) {
  const std::string likest = FindLikest(word, known);
  return likest.empty() ? "" : "; did you mean " + likest + "?";
}

}  // namespace wobble::usage
