// What the server has said last. An order is answered by several lines, each a message of its own.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace wobble::terminal {

class Answer {
 public:
  // now: s.
  void Add(std::string line, double now) {
    if (now > m_newest + kTogether) m_lines.clear();
    if (m_lines.size() == kMostLines) m_lines.erase(m_lines.begin());
    m_lines.push_back(std::move(line));
    m_newest = now;
  }

  // In order; none when there was time to read them.
  [[nodiscard]] std::vector<std::string> Read(double now) const {
    const bool isShown = now < m_newest + kLeastTime + kTimePerLine * static_cast<double>(m_lines.size());
    return isShown ? m_lines : std::vector<std::string>{};
  }

 private:
  static constexpr double kTogether = 0.5;  // s between lines of one answer, at most
  static constexpr double kLeastTime = 3.5;
  static constexpr double kTimePerLine = 0.5;
  static constexpr std::size_t kMostLines = 60;  // more than a screen has; a server may never stop

  std::vector<std::string> m_lines;
  double m_newest = -1e9;
};

}  // namespace wobble::terminal
