// The room physics/model holds the plain data of the engine and the plans that are computed from it once.
//
// A blueprint is the data that all bodies of one kind share and that never changes: topology, rest shape, material, and
// what follows from them once (force coefficients in the kernel's precision, the stability of the body at rest).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/physics/model/cells.h"
#include "server/physics/model/grid_plan.h"
#include "server/physics/model/hinge.h"
#include "server/physics/model/integrator.h"
#include "server/physics/model/sparse_pattern.h"
#include "server/physics/model/sweep_plan.h"
#include "server/physics/model/tetrahedron.h"
#include "server/physics/model/topology.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// One bad parameter: its name in scenes, its value, the range that is allowed.
struct FieldError {
  std::string field;
  std::string value;
  std::string range;
};

// Physical quantities of a body and of the material of its springs. SI units.
struct Material {
  double mass = 8;            // of the whole body, kg
  double stiffness = 150;     // of each spring, N/m
  double dampingRatio = 0.2;  // of each spring between its two masses alone; 1: critical
  // Of the volume against the stiffness of the gas alone; 1: critical. By default five times dampingRatio, at most 1.
  std::optional<double> gasDampingRatio = std::nullopt;
  double gas = 250;                 // nRT of the gas inside, J
  double ambientPressure = 0;       // outside, Pa; the gas pushes with nRT/V minus this
  double friction = 0.8;            // Coulomb's coefficient, static and kinetic
  double restitution = 0.5;         // of a single vertex on a rigid surface
  double contactStiffness = 0;      // of a vertex against a surface, N/m; 0: kContactStiffnessRatio × stiffness
  double drag = 0;                  // ½ρC of the air at its faces, kg/m³; 0.6 is a plate across the wind
  double rollingResistance = 0.03;  // moment on a body that rolls, over normal force and size
  double repulsion = 0;             // force between neighbours at distance d is this/d⁴, N·m⁴

  [[nodiscard]] double FindGasDampingRatio() const { return gasDampingRatio.value_or(std::min(1.0, 5 * dampingRatio)); }
};
inline constexpr double kContactStiffnessRatio = 10;

// Force between vertices a and b: −[k(|l| − r) + c (l̇·l)/|l|] l/|l| on a, the opposite on b, with l = xₐ − x_b.
template <class Real>
struct Spring {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Real restLength = 0;  // r, m
  Real stiffness = 0;   // k, N/m
  Real damping = 0;     // c, N·s/m
};

// The law of contacts between a body and static surfaces. Between bodies the penalty law always holds.
enum class ContactLaw : std::uint8_t {
  kPenalty,       // contact.h
  kMagnetic,      // contact.h
  kBacktracking,  // backtracking.h
};

// The parameters of a body's contact law, for one vertex on a surface.
template <class Real>
struct ContactParameters {
  ContactLaw law = ContactLaw::kPenalty;
  Real stiffness = 0;          // k: slope of the normal force from `fadeDepth` on, N/m
  Real fadeDepth = 0;          // δ: depth up to which force and damping grow smoothly, m
  Real damping = 0;            // of the normal motion beyond δ, N·s/m
  Real stickStiffness = 0;     // of the stick spring, N/m
  Real stickDamping = 0;       // of the dashpot beside it, N·s/m
  Real friction = 0;           // Coulomb's coefficient of this body
  Real rollingResistance = 0;  // C_rr, see step/losses.h
  Real restitution = 0;        // backtracking: speed after a bounce over the speed before
  Real strength = 0;           // magnetic: K, N·m²
  Real floorDistance = 0;      // magnetic: d_m; below it the force goes on along its tangent, m
  Real range = 0;              // contacts are listed up to this distance (magnetic: no force beyond), m; penalty: 0
};

// The shape that a body gets back when it has lost it; the force law is that of methods/recovery.h.
struct ShapeAim {
  std::vector<Vector3d> rest;  // one place a vertex, centre of mass at the origin, m; empty: the body has no aim
  double squareFrequency = 0;  // κ, 1/s²
  double damping = 0;          // γ, 1/s
  // The gas opens what is folded; only a body that was inside out for more than a tick needs the aim, until it is
  // whole.
  bool afterInsideOut = false;
};

// The numbers that the force terms read, in the kernel's precision.
template <class Real>
struct Coefficients {
  std::vector<Real> masses;          // kg, one a vertex
  std::vector<Real> inverseMasses;   // 1/kg; 0: the vertex is fixed, whatever pulls at it
  std::vector<std::uint16_t> fixed;  // the fixed vertices
  std::vector<Spring<Real>> springs;
  std::vector<Tetrahedron<Real>> tetrahedra;  // elements of a solid; most bodies have none
  SolidMaterial<Real> solid;                  // of the tetrahedra
  std::vector<Hinge<Real>> hinges;            // of a sheet that resists bending; others have none
  Real hingeFloorSquare = 0;                  // δ₀² of methods/bending.h, m²
  Cells<Real> cells;                          // of a lattice; others have none
  ShapeAim aim;                               // none: of bodies that have no shape to get back
  std::vector<Face> faces;
  // A planar body lives in the plane y = 0 of its own: nothing accelerates it along y. Its gas is enclosed by
  // `outline`, edges that go round it counter-clockwise as seen from −y, and gas quantities are per metre of depth.
  bool planar = false;
  std::vector<std::array<std::uint16_t, 2>> outline;
  Real gas = 0;              // nRT, J; 0: the body has no gas and the term is skipped
  Real ambientPressure = 0;  // Pa
  Real floorVolume = 0;      // below this volume the pressure grows less, see ComputePressure; m³ (planar: m²)
  Real repulsion = 0;        // K_r between the ends of each spring, N·m⁴; 0: none
  Real drag = 0;             // ½ρC of the medium at every face, kg/m³; 0: none
  Real tearStretch = 0;      // springs tear when longer than this times their rest length; 0: never
  ContactParameters<Real> contact;
  // Factor on all contact forces on a vertex, 0..1, one a vertex: its mass over the largest mass on the skin. Corners
  // and edges of a solid stand for less skin than the middle of a face, in proportion to their mass; with equal
  // stiffness they would ask for up to twice the substeps and press harder than the rest.
  std::vector<Real> contactShares;
};

struct Blueprint {
  std::string name;
  std::vector<Vector3d> rest;  // shape in equilibrium without gravity, centre of mass at the origin, m
  double restVolume = 0;       // m³; planar with gas: m²; 0 when not closed
  double size = 0;             // RMS distance of the rest vertices from the centre, m
  double reach = 0;            // largest such distance, m
  // Radius of a ball about the centre that lies within the rest shape, m; 0: the body is open or planar, or the centre
  // does not see all of the skin from inside.
  double coreRadius = 0;
  double totalMass = 0;  // kg
  // Largest angular frequency at rest, of springs, tetrahedra, hinges and gas, and its damping rate, 1/s;
  // see methods/stability.h.
  double angularFrequency = 0;
  double dampingRate = 0;
  double gasDampingRatio = 0;  // Material::gasDampingRatio
  double gasViscosity = 0;     // c_g of the gas: more pressure per rate of the volume, Pa·s/m³; see step/losses.h
  // The damping rate that drag adds per metre per second of relative speed, 1/m.
  double dragRate = 0;
  // Edges that meet those of other bodies (edges/edge_contact.h), and their radius, m: the springs of a body without
  // faces, and its particles that no spring holds, as balls; the border of a planar body. Others meet with
  // topology.sides, of radius 0.
  std::vector<EdgeEnds> edges;
  double edgeRadius = 0;
  // Edges by which skins meet one another (edges/edge_contact.h): borders, and sides at which the rest shape
  // bends by more than kSharpCosine, outwards if it is closed; and what the faces at each have beside it.
  std::vector<EdgeEnds> sharpEdges;
  std::vector<EdgeWings> sharpWings;
  double sideLength = 0;  // the mean of topology.sides at rest, m; 0 without faces
  double rodRadius = 0;   // set by the maker of a body without faces: of its particles and springs, m
  // Edges that meet others of the same body (edges/self_contact.h), and their radius, m; 0: the body does not meet
  // itself. A skin in space has balls at its vertices, other bodies have `edges`.
  std::vector<EdgeEnds> selfEdges;
  double selfRadius = 0;
  GridShape grid;  // set by the shape's maker if the vertices stand in a grid; empty otherwise
  Integrator integrator = Integrator::kRungeKutta4;
  std::shared_ptr<const SparsePattern> sparsePattern;  // of full.springs; for implicit Euler only
  Topology topology;                                   // of full.faces
  Coefficients<float> single;
  Coefficients<double> full;
  // Plans of the sweep by springs, for packs of bodies and lone bodies; empty if the body cannot be swept.
  SweepPlan<float> singlePlan;
  SweepPlan<double> fullPlan;
  // Plans of the sweep row by row; empty if the body is no grid or cannot be swept so.
  GridPlan<float> singleGridPlan;
  GridPlan<double> fullGridPlan;

  template <class Real>
  [[nodiscard]] const Coefficients<Real>& Read() const {
    if constexpr (std::is_same_v<Real, float>) {
      return single;
    } else {
      return full;
    }
  }
  template <class Real>
  [[nodiscard]] const SweepPlan<Real>& ReadPlan() const {
    if constexpr (std::is_same_v<Real, float>) {
      return singlePlan;
    } else {
      return fullPlan;
    }
  }
  template <class Real>
  [[nodiscard]] const GridPlan<Real>& ReadGridPlan() const {
    if constexpr (std::is_same_v<Real, float>) {
      return singleGridPlan;
    } else {
      return fullGridPlan;
    }
  }
};

// Whether edges of two bodies meet as rods: vertices against faces see nothing where one of them has no faces, or where
// both lie in a plane.
[[nodiscard]] inline bool MeetByRods(const Blueprint& first, const Blueprint& second) {
  return first.rodRadius > 0 || second.rodRadius > 0 || (first.full.planar && second.full.planar);
}

// Whether any edges of two bodies meet: as rods, or the sharp edges of two skins.
[[nodiscard]] inline bool MeetByEdges(const Blueprint& first, const Blueprint& second) {
  return MeetByRods(first, second) || (!first.sharpEdges.empty() && !second.sharpEdges.empty());
}

// The edges of a body that meet those of another; places in this list name them.
[[nodiscard]] inline const std::vector<EdgeEnds>& FindMeetingEdges(const Blueprint& blueprint, const Blueprint& other) {
  if (!MeetByRods(blueprint, other)) return blueprint.sharpEdges;
  return blueprint.edges.empty() ? blueprint.topology.sides : blueprint.edges;
}

// Cosine of the angle between the normals of two faces, about 40°, below which the edge between them is sharp: an
// icosahedron's edges (42°) are, those of a ball of 42 vertices (18°, 23°) are not. Vertices against faces see
// smooth skins as finely as they are drawn, and many sharp edges cost much.
inline constexpr double kSharpCosine = 0.77;

// Repulsion does not grow further once the ends of a spring are nearer than this share of the rest length.
inline constexpr double kRepulsionFloorShare = 0.5;

// The least size in formulas that divide by a body's size, m: a body may be a single particle.
inline constexpr double kMinSize = 0.01;

// Radius of the balls at a skin's vertices by which it meets itself, as a share of the mean length of its sides; why:
// edges/self_contact.h.
inline constexpr double kSelfRadiusShare = 0.4;
// Edges of a body meet if they are farther apart at rest than this share of the distance at which they touch. So what
// is joined is free to bend.
inline constexpr double kSelfApartShare = 3;

// Half of the gap that planar bodies keep in their plane, as a share of the body's size.
inline constexpr double kOutlineRadiusShare = 0.02;

}  // namespace wobble::physics
