// What a packet costs beside its payload, for reports that count kbit/s.
#pragma once

namespace wobble::bench {

inline constexpr double kPacketHeaderBytes = 44;  // IPv4, UDP, ENet with checksum

}  // namespace wobble::bench
