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

// A face that drags, of the place that comes first of its three: the others in the face's order.
struct DraggedFace {
  std::uint32_t others[2] = {};
  std::uint32_t pending[2] = {};  // as an arc's
};

// Two faces whose last place is `last`, last before middle and last middle after: x_last·(x_middle × (x_after −
// x_before)) is six times the volume between them and the origin. Of one face alone `after` is `middle`. Of an outline:
// two edges, before to last and last to after; of one edge alone the other is `last`.
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
  const Real* repulsionFloors = nullptr;      // [arc]
  const DraggedFace* draggedFaces = nullptr;  // those of place i up to draggedEnds[i]
  const std::uint32_t* draggedEnds = nullptr;
  std::uint32_t pendingMask = 0;
  bool planar = false;
  bool hasGas = false;      // in a closed surface
  bool hasOutline = false;  // gas in an outline: ring and wedges are its
  bool isRare = false;      // has such an outline, repulsion, drag or springs that tear
  Real repulsion = 0;       // N·m⁴
  Real dragShare = 0;       // ½ρC/6, kg/m³
  Real ambientPressure = 0;
  Real floorVolume = 0;
};

}  // namespace wobble::physics
