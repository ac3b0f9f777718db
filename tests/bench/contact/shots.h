// One random shot of a body at a target, to be played again by its number.
#pragma once

#include <cstdint>
#include <string>

namespace wobble::bench {

enum class ShotTarget : std::uint8_t { kBody, kPlane, kWall, kSheet };
[[nodiscard]] const char* NameTarget(ShotTarget target);

// kSoft: of bodies that cannot bear the shot; kGhost: with contacts so soft that everything goes through.
enum class ShotKind : std::uint8_t { kFirm, kSoft, kGhost };

struct Shot {
  ShotTarget target = ShotTarget::kBody;
  std::string bodies;
  double speed = 0;   // against the target, m/s
  double offset = 0;  // of the paths of two bodies, by the sum of their radii
  double depth = 0;   // deepest of a vertex inside the other body, or behind the surface, m
  double mostSubsteps = 0;
  bool through = false;
  bool snagged = false;  // in a sheet, by a few vertices
  std::uint32_t inverted = 0;
  std::uint32_t nonFinite = 0;
};

[[nodiscard]] Shot PlayShot(std::uint64_t seed, std::uint32_t number, ShotKind kind);

}  // namespace wobble::bench
