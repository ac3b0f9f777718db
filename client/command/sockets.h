// What a program with very many sockets asks of the system.
#pragma once

namespace wobble::tool {

// Raises the limit on open files, often 1,024, to the most that this process may have.
void AllowManySockets();

}  // namespace wobble::tool
