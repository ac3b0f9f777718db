// Views of players, recorded while they play and compared with the truth after both threads have ended, so that neither
// thread waits for the other or does its work.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "client/client.h"
#include "tests/bench/interpolation/truth.h"

namespace wobble::bench {

// What one player saw at one moment; moment: world time, s.
struct View {
  double moment = 0;
  std::uint32_t ownBody = 0;
  std::vector<client::BodySample> bodies;
};

// Errors of bodies within kNear of a player, the own one included; the server deliberately sends farther bodies less
// precisely. A body that was left out for lack of budget counts as it was shown: late, or at its last position.
struct Shown {
  static constexpr float kNear = 16;     // m, between centres
  static constexpr double kLate = 0.05;  // s

  double error = std::numeric_limits<double>::quiet_NaN();  // % of the body's size, RMS over vertices
  double errorP50 = error;                                  // median of a body's RMS
  double errorP99 = error;                                  // 99th percentile
  double lateShare = 0;  // share of these bodies whose newest record was older than kLate when the newest packet came
  double missingShare = 0;      // share of these bodies that were not shown at all
  double truthErrorOfHalf = 0;  // Truth::ErrorOfHalf, %
};

// What the client shows at `now`, s. shown: as Client::Sample gave it.
[[nodiscard]] View MakeView(const client::Client& client, std::span<const client::BodySample> shown, double now);

// places: ids of the bodies that `truth` records, in its order. nearest: only so many others count, the nearest.
[[nodiscard]] Shown CompareViews(std::span<const View> views, const Truth& truth,
                                 std::span<const physics::BodyId> places,
                                 std::size_t nearest = std::numeric_limits<std::size_t>::max());

}  // namespace wobble::bench
