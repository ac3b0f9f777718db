// Ranks as people write them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/transport/admission.h"

namespace wobble::admission {

inline constexpr std::array<const char*, 4> kRankNames{"watcher", "player", "moderator", "owner"};

[[nodiscard]] inline std::string NameOf(transport::Rank rank) { return kRankNames[static_cast<std::size_t>(rank)]; }

[[nodiscard]] inline std::optional<transport::Rank> ParseRank(std::string_view name) {
  for (std::size_t i = 0; i < kRankNames.size(); ++i) {
    if (name == kRankNames[i]) return static_cast<transport::Rank>(i);
  }
  return {};
}

}  // namespace wobble::admission
