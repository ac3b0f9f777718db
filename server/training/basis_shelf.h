// The bases of a scene's blueprints: from a folder where they were kept, or trained and put there.
#pragma once

#include <filesystem>
#include <vector>

#include "server/scenes/scene.h"
#include "server/training/basis_training.h"

namespace wobble::server {

// One for each blueprint. Trains those that `folder` has not, on up to `threads` threads; an empty path keeps nothing.
// Progress goes to the log. The same scene gives the same bases; a file that is broken is trained anew.
[[nodiscard]] std::vector<Bases> LoadBases(const scenes::Scene& scene, const std::filesystem::path& folder,
                                           int threads);

}  // namespace wobble::server
