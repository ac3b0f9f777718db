// What was probably meant by a word that is not known.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace wobble::usage {

// The least number of letters to add, leave out, replace, or swap with the next one that makes `a` of `b` (optimal
// string alignment: Damerau 1964, without editing a swapped pair again). Time and memory: the product of the lengths.
[[nodiscard]] std::size_t CountEdits(std::string_view a, std::string_view b);

// The known word with the fewest edits, the first of several; empty when all of them need more than a third of the
// letters of `word`, and more than one. Words of more than 64 letters are like nothing.
[[nodiscard]] std::string FindLikest(std::string_view word, std::span<const std::string> known);

// "; did you mean X?", or nothing.
[[nodiscard]] std::string Suggest(std::string_view word, std::span<const std::string> known);

}  // namespace wobble::usage
