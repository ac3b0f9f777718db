// A folder that keeps trained bases from one start of the server to the next.
#pragma once

#include <filesystem>
#include <vector>

#include "server/scenes/scene.h"
#include "server/training/basis_training.h"

namespace wobble::server {

// Loads the bases of each blueprint of the scene, in their order. Trains those that `folder` does not hold, on up to
// `threads` threads, and stores them there; with an empty path it trains all and stores none. Progress and files that
// cannot be written go to the log. The same scene gives the same bases; a broken file is trained and written anew.
[[nodiscard]] std::vector<Bases> LoadBases(const scenes::Scene& scene, const std::filesystem::path& folder,
                                           int threads);

}  // namespace wobble::server
