// Which worlds a server is started with, and whether it can be started at all.
#pragma once

#include <string>
#include <vector>

#include "server/program/options.h"
#include "server/scenes/loader.h"
#include "server/server.h"

namespace wobble::server {

// The scene, or all of the rotation. Mistakes are in options.errors.
[[nodiscard]] std::vector<scenes::LoadResult> LoadScenes(Options& options);

// Every scene with its bases, which are trained one scene after another unless the cache has them.
[[nodiscard]] std::vector<RotationScene> TrainScenes(const Options& options, std::vector<scenes::LoadResult> loaded);

// Every mistake that can be seen without starting anything; with --check also in files that are else read at the start.
[[nodiscard]] std::vector<std::string> FindMistakes(const Options& options,
                                                    const std::vector<scenes::LoadResult>& loaded);

}  // namespace wobble::server
