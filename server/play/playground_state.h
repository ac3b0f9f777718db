// All of a playground that its next ticks depend on and that its scene does not say, as plain data.
#pragma once

#include <map>
#include <optional>

#include "server/physics/world_state.h"
#include "server/play/playground.h"

namespace wobble::server {

struct PlaygroundState {
  physics::WorldState world;
  std::map<ClientId, Playground::Player> players;
  Hands::Memory hands;
  physics::Vector3d gravity = physics::Vector3d::Zero();  // as tuned, m/s²
  double stiffness = 1;                                   // as tuned
  std::optional<Workshop::Memory> workshop;
  std::optional<Game::Memory> game;
};

}  // namespace wobble::server
