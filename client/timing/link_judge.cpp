// A link on which nearly everything is lost would show a world that jumps twice a second and call that playing, so it
// is given up. The window is twice the silence that is allowed: a black-out that ends in time does not fill it.
#include "client/timing/link_judge.h"

#include "protocol/limits.h"

namespace wobble::client {
namespace {

constexpr double kWindow = 2 * protocol::kSilenceTimeout;  // seconds
// Share of the packets sent that must have come, and the fewest packets of which a share says anything.
constexpr double kLeastShare = 0.2;
constexpr std::uint32_t kLeastPackets = 64;

}  // namespace

std::optional<LinkJudge::Loss> LinkJudge::FindHeavyLoss(std::uint32_t newestSequence, std::uint64_t arrived,
                                                        double now) {
  if (now - m_windowBegin < kWindow) return std::nullopt;
  const std::uint32_t sent = newestSequence - m_windowSequence;
  const std::uint64_t came = arrived - m_windowArrived;
  m_windowBegin = now;
  m_windowSequence = newestSequence;
  m_windowArrived = arrived;
  if (sent < kLeastPackets || static_cast<double>(came) >= kLeastShare * sent) return std::nullopt;
  return Loss{.sent = sent, .lost = sent - came};
}

}  // namespace wobble::client
