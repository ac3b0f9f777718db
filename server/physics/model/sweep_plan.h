// The tables that one sweep over a body's vertices reads (kernels/sweep.h), computed once per blueprint.
//
// Vertices stand in breadth-first order over springs and tetrahedra: the neighbours of a vertex are then near it in
// memory, and the forces that it passes on to later vertices fit a small ring. In a grid the order of the vertices'
// numbers does as well, and it is the order of the sweep of kernels/grid.h: both add up in the same order and give the
// same bits, so each body can take whichever sweep is faster.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/kernels/sweep.h"
#include "server/physics/model/grid_plan.h"

namespace wobble::physics {

template <class Real>
struct Coefficients;

template <class Real>
struct SweepPlan {
  std::vector<std::uint16_t> vertices;  // of the blueprint, in the order of the sweep: place -> vertex
  std::vector<std::uint32_t> places;    // vertex -> place
  std::vector<SweepPlace<Real>> at;     // one a place
  std::vector<Arc<Real>> arcs;
  // Gas only: the neighbours round each vertex, counter-clockwise from outside, an even number of them.
  std::vector<std::uint32_t> ring;
  std::vector<Wedge> wedges;  // gas only
  // The arrays of ArcColumns.
  std::vector<std::uint32_t> arcEnds;
  std::vector<Real> stiffnesses;
  std::vector<Real> stiffnessesAtRest;
  std::vector<Real> dampings;
  std::vector<std::uint32_t> springs;  // arc -> spring of the blueprint
  std::vector<Real> repulsionFloors;
  std::vector<DraggedFace> draggedFaces;
  std::vector<std::uint32_t> draggedEnds;
  std::vector<Element<Real>> elements;  // of tetrahedra
  std::vector<std::uint32_t> elementEnds;
  std::vector<std::uint32_t> elementCorners;  // the arrays of ElementColumns
  std::vector<std::uint32_t> elementVertices;
  std::vector<Real> elementNumbers;
  Real restRatio = 1;
  std::vector<HingeArc<Real>> hinges;
  std::vector<std::uint32_t> hingeEnds;
  Real hingeFloorSquare = 0;
  std::uint32_t pendingMask = 0;  // the ring of pending forces has this + 1 slots, a power of two
  bool planar = false;
  bool hasGas = false;
  bool hasOutline = false;
  bool isSolid = false;
  bool isRare = false;
  bool tears = false;
  Real repulsion = 0;
  Real dragShare = 0;
  Real ambientPressure = 0;  // Pa
  Real floorVolume = 0;      // m³; of an outline m²

  // Valid while the plan lives.
  [[nodiscard]] SweepTables<Real> Tables() const {
    return {.count = static_cast<std::uint32_t>(vertices.size()),
            .arcCount = static_cast<std::uint32_t>(arcs.size()),
            .places = at.data(),
            .arcs = arcs.data(),
            .ring = ring.data(),
            .wedges = wedges.data(),
            .columns = {.ends = arcEnds.data(),
                        .stiffnesses = stiffnesses.data(),
                        .stiffnessesAtRest = stiffnessesAtRest.data(),
                        .dampings = dampings.data()},
            .repulsionFloors = repulsionFloors.data(),
            .draggedFaces = draggedFaces.data(),
            .draggedEnds = draggedEnds.data(),
            .elements = elements.data(),
            .elementEnds = elements.empty() ? nullptr : elementEnds.data(),
            .restRatio = restRatio,
            .hinges = hinges.data(),
            .hingeEnds = hinges.empty() ? nullptr : hingeEnds.data(),
            .hingeFloorSquare = hingeFloorSquare,
            .elementColumns = {.ends = elementCorners.data(),
                               .vertices = elementVertices.data(),
                               .numbers = elementNumbers.data(),
                               .count = static_cast<std::uint32_t>(elements.size()),
                               .padded = static_cast<std::uint32_t>(elementNumbers.size()) / kElementNumbers},
            .pendingMask = pendingMask,
            .planar = planar,
            .hasGas = hasGas,
            .hasOutline = hasOutline,
            .isSolid = isSolid,
            .isRare = isRare,
            .repulsion = repulsion,
            .dragShare = dragShare,
            .ambientPressure = ambientPressure,
            .floorVolume = floorVolume};
  }
};

// grid: with columns, the vertices keep the order of their numbers.
template <class Real>
[[nodiscard]] SweepPlan<Real> MakeSweepPlan(const Coefficients<Real>& body, const GridShape& grid);

}  // namespace wobble::physics
