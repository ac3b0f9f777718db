// One random shot of a body at a target; its number reproduces it.
#pragma once

#include <cstdint>
#include <string>

namespace wobble::bench {

enum class ShotTarget : std::uint8_t { kBody, kPlane, kWall, kSheet };
[[nodiscard]] const char* NameTarget(ShotTarget target);

// kFirm: bodies that can bear the shot. kSoft: bodies that cannot. kGhost: contacts so soft that everything passes
// through.
enum class ShotKind : std::uint8_t { kFirm, kSoft, kGhost };

struct Shot {
  ShotTarget target = ShotTarget::kBody;
  std::string bodies;
  double speed = 0;   // relative to the target, m/s
  double offset = 0;  // distance between the paths of two bodies, over the sum of their radii
  double depth = 0;   // greatest depth of a vertex inside the other body or behind the surface, m
  double mostSubsteps = 0;
  bool through = false;
  bool snagged = false;  // a few vertices hang in the sheet
  std::uint32_t inverted = 0;
  std::uint32_t nonFinite = 0;
};

[[nodiscard]] Shot PlayShot(std::uint64_t seed, std::uint32_t number, ShotKind kind);

}  // namespace wobble::bench
