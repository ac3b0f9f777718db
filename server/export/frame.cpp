#include "server/export/frame.h"

namespace wobble::exporting {

const std::vector<std::uint8_t>& ReadTorn(const physics::Body& body) {
  return std::visit([](const auto& state) -> const std::vector<std::uint8_t>& { return state.torn; }, body.state);
}

Skeleton FindSkeleton(const physics::Blueprint& blueprint, const physics::Body& body) {
  Skeleton skeleton{.faces = blueprint.full.faces, .lines = {}, .points = {}};
  if (!skeleton.faces.empty()) return skeleton;
  const std::vector<std::uint8_t>& torn = ReadTorn(body);
  std::vector<bool> isHeld(blueprint.rest.size(), false);
  for (std::size_t i = 0; i < blueprint.full.springs.size(); ++i) {
    if (i < torn.size() && torn[i] != 0) continue;
    const auto& spring = blueprint.full.springs[i];
    skeleton.lines.push_back({static_cast<std::uint16_t>(spring.a), static_cast<std::uint16_t>(spring.b)});
    isHeld[spring.a] = isHeld[spring.b] = true;
  }
  for (std::size_t i = 0; i < isHeld.size(); ++i) {
    if (!isHeld[i]) skeleton.points.push_back(static_cast<std::uint16_t>(i));
  }
  return skeleton;
}

std::string FindPlayerName(const server::Playground& ground, physics::BodyId body) {
  for (const auto& [client, player] : ground.Players()) {
    if (player.body == body) return player.name;
  }
  return {};
}

}  // namespace wobble::exporting
