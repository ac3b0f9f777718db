// The tables of a blueprint that a sweep reads. Every index is multiplied out: 6 times a place is where its numbers
// begin.
#pragma once

#include <cstdint>

namespace wobble::physics {

// A spring from the sweep's vertex to a later one. Its force along l = x − x_other is −[k − k r/|l| + c (l̇·l)/|l|²] l.
template <class Real>
struct Arc {
  std::uint32_t other = 0;
  std::uint32_t pending = 0;  // 3 times the other vertex's slot in the ring of pending forces
  Real stiffness = 0;         // k, N/m
  Real stiffnessAtRest = 0;   // k r, N
  Real damping = 0;           // c, N·s/m
};

// A face with drag, listed at the first of its three places: the other two in the face's order.
struct DraggedFace {
  std::uint32_t others[2] = {};
  std::uint32_t pending[2] = {};  // as Arc::pending
};

// A hinge (model/hinge.h), listed at its first vertex, which must have the first of its places: b, c and d.
template <class Real>
struct HingeArc {
  std::uint32_t others[3] = {};
  std::uint32_t pending[3] = {};  // as Arc::pending
  Real stiffness = 0;
  Real damping = 0;
};

// A tetrahedron (model/tetrahedron.h), listed at the first of its four places: the other three, for each of them how
// its shape function changes, 1/m, and the material's constants times the volume, J and J·s.
template <class Real>
struct Element {
  std::uint32_t others[3] = {};
  std::uint32_t pending[3] = {};  // as Arc::pending
  Real gradients[3][3] = {};
  Real shear = 0;
  Real bulk = 0;
  Real viscosity = 0;
};

// The same elements in the same order, one array a number, each padded to a whole vector: for the sweep of a lone body.
template <class Real>
struct ElementColumns {
  const std::uint32_t* ends =
      nullptr;  // [corner 1 to 3][element][2]: 6 times the corner's place and the first corner's
  const std::uint32_t* vertices = nullptr;  // the same with 3 times the numbers of vertices
  const Real* numbers = nullptr;            // [gradients 3 × 3, shear, bulk, viscosity][element]
  std::uint32_t count = 0;
  std::uint32_t padded = 0;
};
inline constexpr std::uint32_t kElementNumbers = 12;

// The largest over all elements of a body of the bounds of the square of a stretch and of the stiffness, over μ
// (methods/elasticity.cpp).
template <class Real>
struct ElementStrain {
  Real squareStretch = 0;
  Real stiffness = 0;
};

// Two faces whose last place is `last`: (last, before, middle) and (last, middle, after). x_last·(x_middle × (x_after −
// x_before)) is six times the volume between them and the origin. For a single face `after` is `middle`. In an outline:
// two edges, from before to last and from last to after; for a single edge the other end is `last` itself.
struct Wedge {
  std::uint32_t last = 0;
  std::uint32_t before = 0;
  std::uint32_t middle = 0;
  std::uint32_t after = 0;
};

// Where the lists of a place end; they begin where those of the place before end.
template <class Real>
struct SweepPlace {
  Real inverseMass = 0;  // 1/kg; 0: fixed
  std::uint32_t arcEnd = 0;
  std::uint32_t ringEnd = 0;
  std::uint32_t wedgeEnd = 0;
};

// The same springs in the same order, one array a field, padded to a whole vector: for the sweep of a lone body.
template <class Real>
struct ArcColumns {
  const std::uint32_t* ends = nullptr;  // [arc][2]: 6 times the place that has the arc, and Arc::other
  const Real* stiffnesses = nullptr;
  const Real* stiffnessesAtRest = nullptr;
  const Real* dampings = nullptr;
};
inline constexpr std::uint32_t kArcsAtOnce = 8;

// A SweepPlan as bare arrays. Code that is compiled for one instruction set must not share inline functions of the
// standard library with code that is compiled for all: the linker keeps one copy, which may be the wrong one.
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
  const DraggedFace* draggedFaces = nullptr;  // those of place i end at draggedEnds[i]
  const std::uint32_t* draggedEnds = nullptr;
  const Element<Real>* elements = nullptr;     // those of place i end at elementEnds[i]
  const std::uint32_t* elementEnds = nullptr;  // null: there are none
  Real restRatio = 1;                          // of the elements' material
  const HingeArc<Real>* hinges = nullptr;      // those of place i end at hingeEnds[i]
  const std::uint32_t* hingeEnds = nullptr;    // null: there are none
  Real hingeFloorSquare = 0;                   // m²
  ElementColumns<Real> elementColumns;
  std::uint32_t pendingMask = 0;
  bool planar = false;
  bool hasGas = false;       // in a closed skin
  bool hasOutline = false;   // gas in an outline; ring and wedges belong to that
  bool isSolid = false;      // has tetrahedra and neither springs nor any other rare term
  bool isRare = false;       // has tetrahedra, hinges, gas in an outline, repulsion, drag or springs that tear
  Real repulsion = 0;        // N·m⁴
  Real dragShare = 0;        // ½ρC/6, kg/m³
  Real ambientPressure = 0;  // Pa
  Real floorVolume = 0;      // m³; of an outline m²
};

}  // namespace wobble::physics
