// Decides what becomes of each datagram that enters one direction of a link.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "protocol/random.h"
#include "protocol/transport/link_conditions.h"

namespace wobble::transport {

// No copy, one or two, each with the time at which it comes out, in no order.
struct Fate {
  enum class Ending : std::uint8_t { kPasses, kLost, kOverRate, kBlackedOut };
  Ending ending = Ending::kPasses;
  bool isHeldBack = false;
  std::size_t copies = 0;
  std::array<double, 2> due{};  // seconds; of `copies`
};

// The draws of a datagram follow from the seed and its number in this direction alone: each datagram takes the same
// number of draws whatever its conditions and its fate. So more loss loses a superset, and other traffic changes
// nothing.
class LinkDirection {
 public:
  explicit LinkDirection(std::uint64_t seed) : m_random(seed) {}

  // The fate of the next datagram, with a payload of so many bytes. The conditions must be valid; now: seconds since
  // the link began, never backwards.
  [[nodiscard]] Fate Decide(const LinkConditions& conditions, double now, std::size_t bytes);

 private:
  protocol::Random m_random;
  double m_busyUntil = 0;  // when the last datagram in the queue has left at the link's rate
};

// The queue before a limited rate holds kRateQueueSeconds of it, but at least kRateQueueBytes.
inline constexpr double kRateQueueSeconds = 0.25;
inline constexpr double kRateQueueBytes = 3000;
// Bytes of the IPv4 and UDP headers of a datagram.
inline constexpr double kHeaderBytes = 28;

// Seeds for the two directions of a link. Links with different numbers never share a seed.
struct LinkSeeds {
  std::uint64_t toServer;
  std::uint64_t toClient;
};
[[nodiscard]] LinkSeeds MakeLinkSeeds(std::uint64_t seed, std::uint64_t link);

}  // namespace wobble::transport
