// What becomes of each datagram that enters one direction of one link.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "protocol/random.h"
#include "protocol/transport/link_conditions.h"

namespace wobble::transport {

// Nothing (lost, say), one copy or two, each with the moment at which it comes out. In no order.
struct Fate {
  enum class Ending : std::uint8_t { kPasses, kLost, kOverRate, kBlackedOut };
  Ending ending = Ending::kPasses;
  bool isHeldBack = false;
  std::size_t copies = 0;
  std::array<double, 2> due{};  // seconds; of `copies`
};

// All chances follow from the seed and the datagram's number in this direction alone: each takes the same number of
// draws whatever its conditions and its fate, so more loss loses a superset, and no other traffic changes anything.
class LinkDirection {
 public:
  explicit LinkDirection(std::uint64_t seed) : m_random(seed) {}

  // A datagram with a payload of so many bytes enters. The conditions are valid; now: seconds since the link began,
  // never backwards.
  [[nodiscard]] Fate Decide(const LinkConditions& conditions, double now, std::size_t bytes);

 private:
  protocol::Random m_random;
  double m_busyUntil = 0;  // when the last datagram let in will have left at the link's rate
};

// What the queue before a limited rate holds: so many seconds of it, but at least so many bytes.
inline constexpr double kRateQueueSeconds = 0.25;
inline constexpr double kRateQueueBytes = 3000;
// Of IPv4 and UDP, bytes a datagram.
inline constexpr double kHeaderBytes = 28;

// Two seeds for a link's directions. Links with different numbers never share one.
struct LinkSeeds {
  std::uint64_t toServer;
  std::uint64_t toClient;
};
[[nodiscard]] LinkSeeds MakeLinkSeeds(std::uint64_t seed, std::uint64_t link);

}  // namespace wobble::transport
