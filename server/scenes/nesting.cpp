// A scan that knows only what hides dots and brackets: comments and the four kinds of strings. toml++ bounds nested
// values by itself, at 256, but not the parts of a key.
#include "server/scenes/nesting.h"

#include <algorithm>

#include "server/scenes/table_reader.h"

namespace wobble::scenes {
namespace {

class NestingScanner {
 public:
  explicit NestingScanner(std::string_view text) : m_text(text) {}

  std::optional<NestingFault> Scan() {
    while (m_at < m_text.size()) {
      const char c = m_text[m_at];
      if (c == '"' || c == '\'') {
        SkipString(c);
        continue;
      }
      ++m_at;
      if (c == '#') m_at = std::min(m_text.find('\n', m_at), m_text.size());
      if (c == '\n') ++m_line;
      if (c == '.' && ++m_dots >= kMaxKeyParts) {
        return Report("key", "of 1 to " + std::to_string(kMaxKeyParts) + " parts between dots");
      }
      if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) m_dots = 0;
      if (c == '[' || c == '{') ++m_depth;
      if (c == ']' || c == '}') --m_depth;
      if (m_depth > kMaxNesting) {
        return Report("value", "nested at most " + std::to_string(kMaxNesting) + " deep");
      }
    }
    return {};
  }

 private:
  // Shows the beginning of the line in which the scan stands.
  [[nodiscard]] NestingFault Report(const std::string& field, const std::string& range) const {
    const std::size_t begin = m_text.rfind('\n', m_at - 1) + 1;  // npos + 1 is 0
    const std::string shown(m_text.substr(begin, m_at - begin));
    return {m_line, field + " = " + Abbreviate(shown) + ": must be " + range};
  }

  // Moves behind the string that begins here. A string of one line that is not closed there is a mistake, at which the
  // parser stops.
  void SkipString(char quote) {
    const std::string three(3, quote);
    const bool isLong = m_text.substr(m_at, 3) == three;
    for (m_at += isLong ? 3 : 1; m_at < m_text.size(); ++m_at) {
      const char c = m_text[m_at];
      if (c == '\n') {
        if (!isLong) return;
        ++m_line;
      } else if (c == '\\' && quote == '"') {
        if (++m_at < m_text.size() && m_text[m_at] == '\n') ++m_line;
      } else if (c == quote && (!isLong || m_text.substr(m_at, 3) == three)) {
        m_at += isLong ? 3 : 1;
        // A long string may end in one or two quotes of its own.
        for (int own = 0; isLong && own < 2 && m_at < m_text.size() && m_text[m_at] == quote; ++own) ++m_at;
        return;
      }
    }
  }

  std::string_view m_text;
  std::size_t m_at = 0;
  int m_line = 1;
  int m_dots = 0;
  int m_depth = 0;
};

}  // namespace

std::optional<NestingFault> FindDeepNesting(std::string_view toml) { return NestingScanner(toml).Scan(); }

}  // namespace wobble::scenes
