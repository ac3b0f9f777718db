// What wobbled does with worlds in files: recordings and states.
#pragma once

#include <functional>
#include <span>

#include "server/program/options.h"
#include "server/server.h"

namespace wobble::server {

// --replay FILE --verify: prints the verdict, and progress on a terminal. Returns the exit code: 0 identical, 1
// different or broken off, 2 not to be read to its end. isStopAsked: breaks it off.
[[nodiscard]] int VerifyRecording(const Options& options, const std::function<bool()>& isStopAsked);

// --replay FILE --export PATH: prints what was written, and progress on a terminal. Returns the exit code: 0 good; 1
// broken off by isStopAsked or an error, with nothing left, or written up to the recording's damage; 2 not begun.
[[nodiscard]] int ExportRecording(const Options& options, const std::function<bool()>& isStopAsked);

// --list-recordings. Returns the exit code: 2 if there is no such folder, or it cannot be read.
[[nodiscard]] int ListRecordings(const Options& options);

// These return false after they have reported what failed. --replay: shows the recording.
// clock: how much of each tick it takes.
[[nodiscard]] bool StartFilm(const Options& options, recording::Recording film, Server& server, TimeSource clock);
// --state: goes on from the newest checkpoint, if there is one, and keeps checkpoints from here on. sources: of all
// scenes of the server, in their order. now: s.
[[nodiscard]] bool StartKeeping(const Options& options, std::span<const scenes::SceneSource> sources, Server& server,
                                double now);
// --record. source: of the present scene. readUnixTime: s since 1970, called from another thread.
[[nodiscard]] bool StartRecording(const Options& options, const scenes::SceneSource& source, Server& server,
                                  std::uint64_t (*readUnixTime)());

}  // namespace wobble::server
