// Plays a recording and stops at the frames that are wanted.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/export/frame.h"
#include "server/recording/replay.h"
#include "server/recording/verify.h"

namespace wobble::exporting {

struct WalkSettings {
  double from = 0;                                      // s since the recording began
  double to = std::numeric_limits<double>::infinity();  // s, not before `from`; infinite: the recording's end
  double fps = 30;                                      // frames a second, at most the recording's tick rate
  std::vector<physics::BodyId> bodies = {};             // empty: all
};

// Which ticks of a recording are frames.
struct Plan {
  std::uint32_t firstTick = 0;
  std::uint32_t frames = 0;
  double ticksPerFrame = 1;

  [[nodiscard]] std::uint32_t TickOf(std::uint32_t frame) const;
};

// nullopt, and in `error` the option, its value and its range, if the recording has no such frames.
[[nodiscard]] std::optional<Plan> MakePlan(const recording::Recording& recording, const WalkSettings& settings,
                                           std::string& error);

struct Walked {
  // Empty: all went well. The latter is the writer's, in words that follow the file's name.
  std::string error, outputError;
  bool isStopped = false;    // before its last frame; nothing is finished then
  std::uint32_t frames = 0;  // that were written
  double lastTime = 0;       // of the last of them, s since the recording began
  std::size_t bodies = 0;    // different ones, in any frame
};

// Hands all frames to the writer, or those until `progress`, which is called after each, returns false. Chosen bodies
// that are in no frame are an error that names them.
[[nodiscard]] Walked Walk(recording::Recording& recording, recording::Replay& replay, const server::Playground& ground,
                          const WalkSettings& settings, const Plan& plan, FrameWriter& writer,
                          const recording::Progress& progress);

}  // namespace wobble::exporting
