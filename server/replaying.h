// What wobbled does with a recording.
#pragma once

#include <functional>

#include "server/options.h"

namespace wobble::server {

// --replay FILE --verify: prints the verdict, and progress on a terminal. Returns the exit code: 0 identical, 1
// different, 2 not to be read to its end. isStopAsked: judges what was played until then.
[[nodiscard]] int VerifyRecording(const Options& options, const std::function<bool()>& isStopAsked);

// --replay FILE --export PATH: prints what was written, and progress on a terminal. Returns the exit code: 0 good, 2
// not to be read or written. What a stop leaves is whole, and shorter.
[[nodiscard]] int ExportRecording(const Options& options, const std::function<bool()>& isStopAsked);

}  // namespace wobble::server
