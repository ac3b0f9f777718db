// What stands behind a wobble_world: a world of a scene, or a recording that is played.
#pragma once

#include <memory>
#include <string>

#include "server/library/wobble_world.h"
#include "server/physics/world.h"
#include "server/play/playground.h"
#include "server/recording/replay.h"
#include "server/scenes/scene.h"

struct wobble_world {
  // Of a recording; else null.
  struct Film {
    wobble::recording::Recording recording;
    std::unique_ptr<wobble::server::Playground> ground;
    std::unique_ptr<wobble::recording::Replay> replay;
  };

  wobble::scenes::Scene scene;
  std::unique_ptr<wobble::physics::World> own;  // of a scene; else null
  std::unique_ptr<Film> film;

  [[nodiscard]] const wobble::physics::World& World() const { return own ? *own : film->ground->World(); }
};

namespace wobble::library {

// These make *world, or fill in `message` and leave *world alone. Options: checked.
[[nodiscard]] wobble_world_result Load(const wobble_world_options& options, std::unique_ptr<wobble_world>& world,
                                       std::string& message);
[[nodiscard]] wobble_world_result OpenRecording(const char* path, int threads, std::unique_ptr<wobble_world>& world,
                                                std::string& message);

}  // namespace wobble::library
