// What the log says of clients that the vestibule has not let in: a line at once, then a line in ten seconds at most,
// with counts, so that who guesses shows and who floods fills no disk. What was shown never stands in it.
#pragma once

#include <array>
#include <cstdint>

#include "protocol/transport/transport.h"

namespace wobble::admission {

class RefusalLog {
 public:
  // Call it often. statistics: of the server's transport; now: s.
  void Follow(const transport::Statistics& statistics, double now);

 private:
  std::array<std::uint64_t, transport::kTurnawayCount> m_logged{};
  double m_next = 0;  // s, not before it comes the next line
};

}  // namespace wobble::admission
