// What one sweep over a body's vertices needs, worked out once per blueprint.
//
// Vertices stand in breadth-first order over the springs: whatever a vertex is joined to is then near it in memory, and
// the forces that it passes on to vertices further on fit a small ring.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/lanes/sweep.h"

namespace wobble::physics {

template <class Real>
struct Coefficients;

template <class Real>
struct SweepPlan {
  std::vector<std::uint16_t> vertices;  // of the blueprint, in the order of the sweep: place -> vertex
  std::vector<std::uint32_t> places;    // vertex -> place
  std::vector<SweepPlace<Real>> at;     // one a place
  std::vector<Arc<Real>> arcs;
  std::vector<std::uint32_t> ring;  // neighbours round each vertex, counter-clockwise from outside, even; gas only
  std::vector<Wedge> wedges;        // gas only
  // ArcColumns:
  std::vector<std::uint32_t> arcEnds;
  std::vector<Real> stiffnesses;
  std::vector<Real> stiffnessesAtRest;
  std::vector<Real> dampings;
  std::uint32_t pendingMask = 0;  // forces on places further on fit a ring of this + 1
  bool planar = false;
  bool hasGas = false;
  Real ambientPressure = 0;  // Pa
  Real floorVolume = 0;      // m³

  [[nodiscard]] SweepTables<Real> Tables() const {
    return {static_cast<std::uint32_t>(vertices.size()),
            static_cast<std::uint32_t>(arcs.size()),
            at.data(),
            arcs.data(),
            ring.data(),
            wedges.data(),
            {arcEnds.data(), stiffnesses.data(), stiffnessesAtRest.data(), dampings.data()},
            pendingMask,
            planar,
            hasGas,
            ambientPressure,
            floorVolume};
  }
};

// Of a body without repulsion, drag, gas in an outline and springs that tear: the sweep knows none of these, and bodies
// that have one get an empty plan.
template <class Real>
[[nodiscard]] SweepPlan<Real> MakeSweepPlan(const Coefficients<Real>& body);

}  // namespace wobble::physics
