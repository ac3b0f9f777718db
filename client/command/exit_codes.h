// The exit codes of the commands of `wobble`.
#pragma once

namespace wobble::command {

inline constexpr int kExitGood = 0;
inline constexpr int kExitFailed = 1;            // something failed while it ran
inline constexpr int kExitBadUse = 2;            // bad options or files, no server, refused by the server
inline constexpr int kExitThresholdFailed = 99;  // of `wobble bots`

}  // namespace wobble::command
