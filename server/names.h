// Players' names and lines: what they may hold, and that no two players of a world have names that look alike.
//
// Names are the only mark by which players know one another, and they are shown in every client and in the log. The
// rules are Unicode's: NFKC (UAX 15) makes one spelling of what is the same text, and the skeletons of UTS 39 are equal
// where two texts look alike, such as Latin "a" and Cyrillic "а".
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace wobble::server {

// Makes a text out of any bytes: valid UTF-8 in NFKC on one line, without control, format and other invisible
// characters, with single spaces inside and none at its ends, at most maxBytes long and cut between code points. May be
// empty.
[[nodiscard]] std::string CleanText(std::string_view bytes, std::size_t maxBytes);

// A text of at most protocol::kMaxNameBytes; "player" when nothing is left.
[[nodiscard]] std::string CleanName(std::string_view bytes);

// The cleaned name, with " 2", " 3" and so on at its end when it looks like a name in `taken`: the first number that
// makes it differ from all of them. Its end is cut where the number would not fit. Costs about two microseconds for
// each name in `taken`; it is called once a join or
// renaming.
[[nodiscard]] std::string MakeDistinct(const std::string& name, std::span<const std::string_view> taken);

}  // namespace wobble::server
