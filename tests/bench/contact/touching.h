// Worlds of bodies that touch obstacles and one another, for judging the server's stepping in contact.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

struct TouchingCase {
  std::string name;
  std::function<std::unique_ptr<physics::World>(double errorTarget)> make;  // errorTarget: m/s
  // Called before every second of play; null: nobody steers.
  std::function<void(physics::World& world, int second)> steer = nullptr;
  const char* key = nullptr;  // error_target_met_KEY is its own figure; null: it has none
  bool isLimited = true;      // counts in error_target_met_in_contact, which has a limit
};

// Bounce, roll, slide, tumble, collide, stack, squeeze, fall on cloth, cloth over a ball, crowd, with the friction and
// losses of the scenes. quick: a subset.
[[nodiscard]] std::vector<TouchingCase> MakeTouchingCases(bool quick);

// Whether the body touched an obstacle or another body at the end of the last tick.
[[nodiscard]] bool TouchesAnything(const physics::Body& body);

}  // namespace wobble::bench
