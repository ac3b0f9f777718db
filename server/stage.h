// A scene that is played, and what clients are sent of it: all of a server that ends with the scene.
#pragma once

#include <vector>

#include "server/config.h"
#include "server/play/playground.h"
#include "server/scenes/loader.h"
#include "server/snapshots/capture.h"
#include "server/snapshots/snapshot_store.h"

namespace wobble::server {

struct Stage {
  // watch: outlives the stage. A stage may be made on another thread than it is played on.
  Stage(const Config& config, scenes::Scene scene, std::vector<Bases> bases, PhaseWatch& watch)
      : playground(std::move(scene),
                   {.tickDuration = 1.0 / config.tickHz, .seed = config.seed, .threads = config.threads}),
        grounds(CaptureGrounds(playground.World().Obstacles())),
        store(playground.World(), config.threads, std::move(bases), watch) {}

  Playground playground;
  std::vector<CapturedGround> grounds;
  SnapshotStore store;
};

// A scene of a rotation, ready to be played.
struct RotationScene {
  scenes::Scene scene;
  scenes::SceneSource source;
  std::vector<Bases> bases;  // of its blueprints, in their order; empty: none
};

}  // namespace wobble::server
