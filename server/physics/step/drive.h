// What acts on a world by the clock: a push, a breath, a gust, now and then or all the time.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/physics/step/body.h"

namespace wobble::physics {

// On from `begin` up to `end` of each `period`, constant through a tick.
struct Drive {
  BodyId body = 0;                      // 0: on all, by its wind
  std::vector<std::uint16_t> vertices;  // that the force is shared by, equally
  Vector3d force = Vector3d::Zero();    // N, of all of them together
  double gasFactor = 1;                 // times the body's gas
  Vector3d wind = Vector3d::Zero();     // added to the world's, m/s
  double begin = 0;                     // s
  double end = 1;                       // s
  double period = 2;                    // s, from the world's first tick
};

[[nodiscard]] inline bool IsOn(const Drive& drive, double time) {
  const double phase = time - drive.period * std::floor(time / drive.period);
  return phase >= drive.begin && phase < drive.end;
}

}  // namespace wobble::physics
