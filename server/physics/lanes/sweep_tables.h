// What a sweep needs to know of a blueprint. Every index is an offset: 6 times a place, for its numbers begin there.
#pragma once

#include <cstdint>

namespace wobble::physics {

// A spring of the vertex that the sweep is at, to one further on. Its force along l = x − x_other is
// −[k − k r/|l| + c (l̇·l)/|l|²] l.
template <class Real>
struct Arc {
  std::uint32_t other = 0;
  std::uint32_t pending = 0;  // 3 times the other's slot in the ring of pending forces
  Real stiffness = 0;         // k, N/m
  Real stiffnessAtRest = 0;   // k r, N
  Real damping = 0;           // c, N·s/m
};

// Two faces whose last place is `last`, last before middle and last middle after: x_last·(x_middle × (x_after −
// x_before)) is six times the volume between them and the origin. Of one face alone `after` is `middle`.
struct Wedge {
  std::uint32_t last = 0;
  std::uint32_t before = 0;
  std::uint32_t middle = 0;
  std::uint32_t after = 0;
};

// What a place has begins where that of the place before ends.
template <class Real>
struct SweepPlace {
  Real inverseMass = 0;  // 1/kg; 0: fixed
  std::uint32_t arcEnd = 0;
  std::uint32_t ringEnd = 0;
  std::uint32_t wedgeEnd = 0;
};

// The same springs in the same order for a body alone, an array each, up to a whole vector above their number.
template <class Real>
struct ArcColumns {
  const std::uint32_t* ends = nullptr;  // [arc][2]: whose it is, and the other
  const Real* stiffnesses = nullptr;
  const Real* stiffnessesAtRest = nullptr;
  const Real* dampings = nullptr;
};
inline constexpr std::uint32_t kArcsAtOnce = 8;

// A SweepPlan as bare arrays: what is compiled for one instruction set must not share inline functions of the standard
// library with what is compiled for all.
template <class Real>
struct SweepTables {
  std::uint32_t count = 0;
  std::uint32_t arcCount = 0;
  const SweepPlace<Real>* places = nullptr;
  const Arc<Real>* arcs = nullptr;
  const std::uint32_t* ring = nullptr;
  const Wedge* wedges = nullptr;
  ArcColumns<Real> columns;
  std::uint32_t pendingMask = 0;
  bool planar = false;
  bool hasGas = false;
  Real ambientPressure = 0;
  Real floorVolume = 0;
};

}  // namespace wobble::physics
