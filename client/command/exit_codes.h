// How the commands of `wobble` end.
#pragma once

namespace wobble::tool {

inline constexpr int kExitGood = 0;
inline constexpr int kExitFailed = 1;            // something went wrong on the way
inline constexpr int kExitBadUse = 2;            // options, files, no server, turned away
inline constexpr int kExitThresholdFailed = 99;  // of `wobble bots`

}  // namespace wobble::tool
