// A body of a system that is being stepped, for the methods that need more than its accelerations: implicit Euler and
// position Verlet.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/contact/contact.h"
#include "server/physics/contact/obstacle.h"
#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"

namespace wobble::physics {

template <class Real>
struct SteppedBody {
  const Blueprint* blueprint = nullptr;
  const Load<Real>* load = nullptr;
  std::span<const Surface<Real>> surfaces;
  std::span<const Contact<Real>> contacts;
  std::span<const std::uint8_t> torn;  // State::torn
  std::size_t begin = 0;               // of its vertices in the system's arrays
};

template <class Real>
[[nodiscard]] bool IsTorn(const SteppedBody<Real>& body, std::size_t spring) {
  return !body.torn.empty() && body.torn[spring] != 0;
}

}  // namespace wobble::physics
