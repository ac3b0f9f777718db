// Whether a person sits at the program.
#pragma once

namespace wobble::usage {

// Whether this process has a terminal that is still open. SIGHUP says that it was closed; to a program that never had
// one, or has it still, somebody has sent the signal so that it reads its files again.
[[nodiscard]] bool HasTerminal();

}  // namespace wobble::usage
