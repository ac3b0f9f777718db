// What players saw, kept while they play, and how far it was from the truth, found when both threads have ended: so
// neither waits for the other, or works for it.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "client/client.h"
#include "tests/bench/interpolation/truth.h"

namespace wobble::bench {

// One player at one moment, of the world's time, s.
struct View {
  double moment = 0;
  std::uint32_t ownBody = 0;
  std::vector<client::BodySample> bodies;
};

// Of all bodies near a player, kNear: further off the server means to be less exact. A body that was crowded out of its
// turn counts as it was shown: late, or where it last was.
struct Shown {
  static constexpr float kNear = 16;  // m, from centre to centre

  double error = std::numeric_limits<double>::quiet_NaN();  // % of the body's size, RMS over vertices
  double errorP99 = error;                                  // 99th percentile of a body's RMS
  double missingShare = 0;                                  // of them, those that were not shown at all
  double truthErrorOfHalf = 0;                              // see Truth, %
};

// places: of the bodies that the truth is of, their ids.
[[nodiscard]] Shown CompareViews(std::span<const View> views, const Truth& truth,
                                 std::span<const physics::BodyId> places);

}  // namespace wobble::bench
