// Whom the camera of somebody without a body follows.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace wobble::terminal {

inline constexpr char32_t kFollowKey = U'b';
inline constexpr char32_t kReadyKey = U'y';  // says that the player is ready, in a game

class Followed {
 public:
  // Goes on to the next player, and from the last to nobody. players: names by body. Returns a line that says so.
  std::string ChooseNext(const std::map<std::uint32_t, std::string>& players) {
    const auto next = players.upper_bound(m_body);
    m_body = next == players.end() ? 0 : next->first;
    if (m_body != 0) return "follows " + next->second;
    return players.empty() ? "nobody to follow" : "follows nobody";
  }

  // 0: nobody's. It stays chosen while it is not there, as in a recording that is wound.
  [[nodiscard]] std::uint32_t Body() const { return m_body; }

 private:
  std::uint32_t m_body = 0;
};

}  // namespace wobble::terminal
