// Forces, gas and wind that a scene applies by the clock: periodically or all the time.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/physics/step/body.h"

namespace wobble::physics {

// Acts from `begin` up to `end` of each `period`, constant through a tick.
struct Drive {
  BodyId body = 0;                      // 0: all bodies, for wind
  std::vector<std::uint16_t> vertices;  // share the force equally
  Vector3d force = Vector3d::Zero();    // total over the vertices, N
  double gasFactor = 1;                 // times the body's gas while it acts
  Vector3d wind = Vector3d::Zero();     // added to the world's, m/s
  double begin = 0;                     // s
  double end = 1;                       // s
  double period = 2;                    // s, from the world's first tick
};

// time: s since the world's first tick.
[[nodiscard]] inline bool IsOn(const Drive& drive, double time) {
  const double phase = time - drive.period * std::floor(time / drive.period);
  return phase >= drive.begin && phase < drive.end;
}

}  // namespace wobble::physics
