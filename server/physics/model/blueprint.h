// What all bodies of one kind share and nothing ever changes: topology, rest shape, material, and what follows from
// them once (force coefficients in the precision of the kernel, the stability of the body at rest).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/physics/model/grid_plan.h"
#include "server/physics/model/integrator.h"
#include "server/physics/model/sparse_pattern.h"
#include "server/physics/model/sweep_plan.h"
#include "server/physics/model/topology.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// One bad parameter: what it is called in scenes, what it was, what it may be.
struct FieldError {
  std::string field;
  std::string value;
  std::string range;
};

// Physical quantities of a body and of the material that its springs are made of. SI units.
struct Material {
  double mass = 8;              // of the whole body, kg
  double stiffness = 150;       // of each spring, N/m
  double dampingRatio = 0.2;    // of each spring between its two masses alone, 1: critical
  double gas = 250;             // nRT of the gas inside, J
  double ambientPressure = 0;   // outside, Pa; the gas pushes with nRT/V minus this
  double friction = 0.8;        // Coulomb's coefficient, static and kinetic
  double restitution = 0.5;     // of a single vertex on a rigid surface
  double contactStiffness = 0;  // of a vertex against a surface, N/m; 0: kContactStiffnessRatio x stiffness
  double drag = 0;              // ½ρC of the air round its faces, kg/m³: 0.6 on a plate across the wind
  double repulsion = 0;         // between neighbours at distance d: this/d⁴, N·m⁴
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

// How a body meets static surfaces; bodies meet one another by the penalty law whatever theirs is.
enum class ContactLaw : std::uint8_t {
  kPenalty,       // contact.h
  kMagnetic,      // contact.h
  kBacktracking,  // backtracking.h
};

// How a vertex of the body meets a surface.
template <class Real>
struct ContactParameters {
  ContactLaw law = ContactLaw::kPenalty;
  Real stiffness = 0;       // k_c: slope of the normal force from `fadeDepth` on, N/m
  Real fadeDepth = 0;       // δ: depth up to which force and damping grow smoothly, m
  Real damping = 0;         // of the normal motion beyond δ, N·s/m
  Real stickStiffness = 0;  // of the anchor spring, N/m
  Real stickDamping = 0;    // beside it, N·s/m
  Real friction = 0;        // Coulomb's coefficient of this body
  Real restitution = 0;     // backtracking: speed after a bounce over that before it
  Real strength = 0;        // magnetic: K, N·m²
  Real floorDistance = 0;   // magnetic: nearer than this the force goes on along its tangent, m
  Real range = 0;           // vertices farther than this from a surface are none of its business, m
};

// All that the force terms read, in the kernel's precision.
template <class Real>
struct Coefficients {
  std::vector<Real> masses;          // kg, one a vertex
  std::vector<Real> inverseMasses;   // 1/kg; 0: the vertex is fixed, whatever pulls at it
  std::vector<std::uint16_t> fixed;  // those vertices
  std::vector<Spring<Real>> springs;
  std::vector<Face> faces;
  // A planar body lives in the plane y = 0 of its own: nothing accelerates it along y. Its gas is held by `outline`,
  // edges that go round it counter-clockwise as seen from −y, and all that follows is per metre of depth.
  bool planar = false;
  std::vector<std::array<std::uint16_t, 2>> outline;
  Real gas = 0;              // nRT, J; 0: the body has no gas and the term is skipped
  Real ambientPressure = 0;  // Pa
  Real floorVolume = 0;      // below this the pressure is continued linearly, m³ (planar: m²)
  Real repulsion = 0;        // K_r between the ends of each spring, N·m⁴; 0: none
  Real drag = 0;             // ½ρC of the medium on every face, kg/m³; 0: none
  Real tearStretch = 0;      // springs tear when longer than this times their rest length; 0: never
  ContactParameters<Real> contact;
  // Of each vertex, times all contact forces on it, 0..1: its mass over the heaviest on the surface. Corners and edges
  // of a solid stand for less surface than the middle of a face, in the measure in which they carry less mass; with
  // equal stiffness they would ask for up to twice the substeps and press harder than the rest.
  std::vector<Real> contactShares;
};

struct Blueprint {
  std::string name;
  std::vector<Vector3d> rest;  // shape in equilibrium without gravity, centre of mass at the origin, m
  double restVolume = 0;       // m³; planar with gas: m²; 0 when not closed
  double size = 0;             // RMS distance of the rest vertices from the centre, m
  double reach = 0;            // largest such distance, m
  double totalMass = 0;        // kg
  // Largest angular frequency at rest (springs and gas) and the damping rate that goes with it, 1/s; see stability.h.
  double angularFrequency = 0;
  double dampingRate = 0;
  // What drag adds to it at a metre per second of relative speed, 1/m.
  double dragRate = 0;
  GridShape grid;  // in which the vertices stand, if they do; its maker's to say
  Integrator integrator = Integrator::kRungeKutta4;
  std::shared_ptr<const SparsePattern> sparsePattern;  // of full.springs; for implicit Euler only
  Topology topology;                                   // of full.faces
  Coefficients<float> single;
  Coefficients<double> full;
  // How it is stepped in lanes; empty when it cannot be.
  SweepPlan<float> singlePlan;
  SweepPlan<double> fullPlan;
  // How one of them is, row by row; likewise.
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

// Repulsion stays what it is at this share of the rest length when the ends of a spring come nearer than that.
inline constexpr double kRepulsionFloorShare = 0.5;

// A body is at least this large in formulas that divide by its size, m: it may be a single particle.
inline constexpr double kMinSize = 0.01;

}  // namespace wobble::physics
