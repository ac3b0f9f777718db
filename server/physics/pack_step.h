// One tick of bodies that touch no other: those of one blueprint that ask for the same number of substeps are stepped
// side by side, a lane each. What a body does depends on nothing that the others of its pack do.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/group_step.h"
#include "server/physics/lanes/kernels.h"
#include "server/physics/pack_contacts.h"

namespace wobble::physics {

// Reused from pack to pack.
template <class Real>
struct PackScratch {
  struct alignas(64) Line {
    std::array<std::byte, 64> bytes;
  };
  std::vector<Line> lines;                 // all that the sweep works on
  std::vector<std::uint8_t> hasOuter;      // SweepLanes
  std::vector<std::uint32_t> outerPlaces;  // those
  // Of one body, with what contacts read and write.
  std::vector<Vector3<Real>> positions;
  std::vector<Vector3<Real>> velocities;
  std::vector<Vector3<Real>> forces;
  PackContacts<Real> contacts;
  std::array<GroupScratch<Real>, kWidestPack> groups;

  // For a pack of the largest body there is.
  void Reserve(std::size_t vertices);
};

// Whether the body's own blueprint lets it be stepped in lanes.
template <class Real>
[[nodiscard]] bool CanGoInPack(const Blueprint& blueprint);

// Substeps that the first try of a body's tick takes.
template <class Real>
[[nodiscard]] int FindFirstSubsteps(const Member<Real>& member, const StepRules& rules);

// Equal substeps, with nobody to choose or judge them: for the laboratory. Members as for StepPack.
template <class Real>
void IntegratePack(std::span<Member<Real>*> members, double duration, int substeps,
                   std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch);

// At most as many members as the widest kernel has lanes, all of one blueprint, which begin with `substeps`. outcomes:
// one a member.
template <class Real>
void StepPack(std::span<Member<Real>*> members, int substeps, const StepRules& rules,
              std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch, std::span<GroupOutcome> outcomes);

}  // namespace wobble::physics
