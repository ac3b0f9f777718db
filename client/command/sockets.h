// The system's limit on sockets.
#pragma once

namespace wobble::command {

// Raises the limit on open files, often 1,024, to the most that this process may have. For commands with many sockets.
void AllowManySockets();

}  // namespace wobble::command
