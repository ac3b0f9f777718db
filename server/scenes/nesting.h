// How deeply a TOML text is nested, before it is parsed. The parser, its tables' destructors and the writer of error
// messages call themselves once a level, so a key of 50,000 dots would use up the stack.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wobble::scenes {

// The shipped scenes need 2 parts of a key and 2 levels of arrays.
inline constexpr int kMaxKeyParts = 16;
inline constexpr int kMaxNesting = 16;

struct NestingFault {
  int line = 1;
  std::string what;  // "key = a.a.a.a.a.a.a.a...: must be of 1 to 16 parts between dots"
};

// The first place where a key has more than kMaxKeyParts parts, or arrays and inline tables are more than kMaxNesting
// deep. Of a text that is not valid TOML it may find less than there is, but never less than the parser would have seen
// before the first error.
[[nodiscard]] std::optional<NestingFault> FindDeepNesting(std::string_view toml);

}  // namespace wobble::scenes
