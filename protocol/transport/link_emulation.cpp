// The fate of a datagram is decided when it enters, so it needs no further look on its way and tests need neither
// sockets nor a clock.
//
// A datagram passes, in this order: the queue before the bottleneck, whose tail is dropped when it is full; the wire,
// which loses, delays, holds back and duplicates; and a black-out, which drops all that enters or would come out while
// it lasts. A black-out stores nothing: no radio keeps datagrams and releases them in a burst afterwards, and a client
// could not tell such a burst from a flood. A datagram that is lost has used up rate; a second copy has not.
#include "protocol/transport/link_emulation.h"

#include <algorithm>

namespace wobble::transport {

Fate LinkDirection::Decide(const LinkConditions& conditions, double now, std::size_t bytes) {
  const double lossDraw = m_random.NextShare();
  const double trip = conditions.delay + conditions.jitter * m_random.NextShare();
  const bool isHeldBack = m_random.NextShare() < conditions.reorder;
  const bool isDoubled = m_random.NextShare() < conditions.duplicate;
  const double secondTrip = conditions.delay + conditions.jitter * m_random.NextShare();

  Fate fate;
  double leaves = now;
  if (conditions.rate > 0) {
    const double bits = 8 * (static_cast<double>(bytes) + kHeaderBytes);
    const double room = std::max(kRateQueueSeconds, 8 * kRateQueueBytes / conditions.rate);
    leaves = std::max(now, m_busyUntil) + bits / conditions.rate;
    if (leaves > now + room) {
      fate.ending = Fate::Ending::kOverRate;
      return fate;
    }
    m_busyUntil = leaves;
  }
  if (lossDraw < conditions.loss) {
    fate.ending = Fate::Ending::kLost;
    return fate;
  }
  const bool entersBlack = IsBlack(conditions.blackout, now);
  const auto add = [&](double due) {
    if (!entersBlack && !IsBlack(conditions.blackout, due)) fate.due[fate.copies++] = due;
  };
  if (isDoubled) add(leaves + secondTrip);
  add(leaves + trip + (isHeldBack ? conditions.reorderDelay : 0));
  if (fate.copies == 0) fate.ending = Fate::Ending::kBlackedOut;
  fate.isHeldBack = isHeldBack && fate.copies > 0;
  return fate;
}

LinkSeeds MakeLinkSeeds(std::uint64_t seed, std::uint64_t link) {
  protocol::Random seeds(seed + link * 0xD1342543DE82EF95u);  // an odd factor: links never share a seed
  const std::uint64_t toServer = seeds.Next();
  return {toServer, seeds.Next()};
}

}  // namespace wobble::transport
