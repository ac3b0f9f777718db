// The system's sockets: how many there may be, and whether a port is free.
#pragma once

#include <cstdint>
#include <string>

namespace wobble::command {

// Raises the limit on open files, often 1,024, to the most that this process may have. For commands with many sockets.
void AllowManySockets();

enum class PortKind : std::uint8_t { kTcp, kUdp };
// Whether a program may listen at this port of an IP address of this machine; port 0 is free. False with one line in
// `error`, such as "port 8080 (TCP) is in use". Another program may take it a moment later.
[[nodiscard]] bool IsFree(PortKind kind, const std::string& address, std::uint16_t port, std::string& error);

}  // namespace wobble::command
