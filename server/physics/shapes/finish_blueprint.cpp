// Everything that a maker of shapes need not know: it fills in `rest` and `full`, and the rest follows from these here.
#include "server/physics/shapes/finish_blueprint.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/physics/contact/backtracking.h"
#include "server/physics/methods/forces.h"
#include "server/physics/methods/stability.h"

namespace wobble::physics {
namespace {

// The tick rate that scenes are checked for.
constexpr double kTickHz = 60;

ContactParameters<float> ToSingle(const ContactParameters<double>& c) {
  return {.law = c.law,
          .stiffness = static_cast<float>(c.stiffness),
          .fadeDepth = static_cast<float>(c.fadeDepth),
          .damping = static_cast<float>(c.damping),
          .stickStiffness = static_cast<float>(c.stickStiffness),
          .stickDamping = static_cast<float>(c.stickDamping),
          .friction = static_cast<float>(c.friction),
          .rollingResistance = static_cast<float>(c.rollingResistance),
          .restitution = static_cast<float>(c.restitution),
          .strength = static_cast<float>(c.strength),
          .floorDistance = static_cast<float>(c.floorDistance),
          .range = static_cast<float>(c.range)};
}

Cells<float> ToSingle(const Cells<double>& cells) {
  Cells<float> single{.first = cells.first,
                      .strides = cells.strides,
                      .isEdge = {},
                      .edge = static_cast<float>(cells.edge),
                      .stiffness = static_cast<float>(cells.stiffness),
                      .damping = static_cast<float>(cells.damping),
                      .cornerMass = static_cast<float>(cells.cornerMass),
                      .squareFrequency = cells.squareFrequency};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    single.isEdge[axis].assign(cells.isEdge[axis].begin(), cells.isEdge[axis].end());
  }
  return single;
}

Coefficients<float> ToSingle(const Coefficients<double>& full) {
  Coefficients<float> single;
  single.masses.assign(full.masses.begin(), full.masses.end());
  single.inverseMasses.assign(full.inverseMasses.begin(), full.inverseMasses.end());
  single.fixed = full.fixed;
  single.springs.reserve(full.springs.size());
  for (const Spring<double>& s : full.springs) {
    single.springs.push_back({.a = s.a,
                              .b = s.b,
                              .restLength = static_cast<float>(s.restLength),
                              .stiffness = static_cast<float>(s.stiffness),
                              .damping = static_cast<float>(s.damping)});
  }
  for (const Tetrahedron<double>& t : full.tetrahedra) {
    Tetrahedron<float>& element = single.tetrahedra.emplace_back();
    element.vertices = t.vertices;
    for (std::size_t i = 0; i < 3; ++i) std::ranges::copy(t.gradients[i], element.gradients[i].begin());
    element.volume = static_cast<float>(t.volume);
  }
  single.solid = {.shear = static_cast<float>(full.solid.shear),
                  .bulk = static_cast<float>(full.solid.bulk),
                  .restRatio = static_cast<float>(full.solid.restRatio),
                  .viscosity = static_cast<float>(full.solid.viscosity)};
  for (const Hinge<double>& h : full.hinges) {
    single.hinges.push_back({.vertices = h.vertices,
                             .stiffness = static_cast<float>(h.stiffness),
                             .damping = static_cast<float>(h.damping)});
  }
  single.hingeFloorSquare = static_cast<float>(full.hingeFloorSquare);
  single.cells = ToSingle(full.cells);
  single.aim = full.aim;
  single.faces = full.faces;
  single.planar = full.planar;
  single.outline = full.outline;
  single.gas = static_cast<float>(full.gas);
  single.ambientPressure = static_cast<float>(full.ambientPressure);
  single.floorVolume = static_cast<float>(full.floorVolume);
  single.repulsion = static_cast<float>(full.repulsion);
  single.drag = static_cast<float>(full.drag);
  single.tearStretch = static_cast<float>(full.tearStretch);
  single.contact = ToSingle(full.contact);
  single.contactShares.assign(full.contactShares.begin(), full.contactShares.end());
  return single;
}

// Calls visit(a, b) for each side of a face that has no face across it.
template <class Visit>
void VisitBorder(const Blueprint& blueprint, const Visit& visit) {
  const Topology& topology = blueprint.topology;
  for (std::size_t f = 0; f < topology.neighbours.size(); ++f) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Face& face = blueprint.full.faces[f];
      if (topology.neighbours[f][corner] == kNoFace) visit(face[(corner + 1) % 3], face[(corner + 2) % 3]);
    }
  }
}

// The vertices that may touch something. Of a planar body these are the ones on its border, though faces cover all of
// it.
std::vector<std::uint16_t> FindOuterVertices(const Blueprint& blueprint) {
  if (!blueprint.full.planar) return blueprint.topology.vertices;
  std::vector<std::uint16_t> outer;
  VisitBorder(blueprint, [&](std::uint16_t a, std::uint16_t) { outer.push_back(a); });
  return outer;
}

// The share of each vertex in a contact: its mass over that of the heaviest outer vertex. A body without faces has no
// surface to share, so each of its vertices has 1.
void FindContactShares(Blueprint& blueprint) {
  Coefficients<double>& full = blueprint.full;
  full.contactShares.assign(full.masses.size(), 1);
  if (full.faces.empty()) return;
  double heaviest = 0;
  const std::vector<std::uint16_t> outer = FindOuterVertices(blueprint);
  for (const std::uint16_t vertex : outer) heaviest = std::max(heaviest, full.masses[vertex]);
  for (const std::uint16_t vertex : outer) full.contactShares[vertex] = full.masses[vertex] / heaviest;
}

// Blueprint::edges.
void FindEdges(Blueprint& blueprint) {
  const Coefficients<double>& full = blueprint.full;
  blueprint.edges.clear();
  blueprint.edgeRadius = 0;
  if (full.faces.empty()) {
    blueprint.edgeRadius = blueprint.rodRadius;
    std::vector<bool> isHeld(full.masses.size(), false);
    for (const Spring<double>& spring : full.springs) {
      blueprint.edges.push_back({static_cast<std::uint16_t>(spring.a), static_cast<std::uint16_t>(spring.b)});
      isHeld[spring.a] = isHeld[spring.b] = true;
    }
    for (std::size_t i = 0; i < isHeld.size(); ++i) {
      const auto particle = static_cast<std::uint16_t>(i);
      if (!isHeld[i]) blueprint.edges.push_back({particle, particle});
    }
  } else if (full.planar) {
    blueprint.edgeRadius = kOutlineRadiusShare * blueprint.size;
    VisitBorder(blueprint, [&](std::uint16_t a, std::uint16_t b) { blueprint.edges.push_back({a, b}); });
  }
}

// Whether the side of face `f` opposite to its corner is sharp in the rest shape; each side counts for one of its
// faces.
bool IsSharp(const Blueprint& blueprint, std::size_t f, std::size_t corner) {
  const std::uint16_t neighbour = blueprint.topology.neighbours[f][corner];
  if (neighbour == kNoFace) return true;
  if (neighbour < f) return false;
  const auto findArea = [&](const Face& face) -> Vector3d {
    const Vector3d& a = blueprint.rest[face[0]];
    return (blueprint.rest[face[1]] - a).cross(blueprint.rest[face[2]] - a);
  };
  const Face& face = blueprint.full.faces[f];
  const Vector3d area = findArea(face);
  const Vector3d other = findArea(blueprint.full.faces[neighbour]);
  const Vector3d across = blueprint.rest[blueprint.topology.across[f][corner]] - blueprint.rest[face[corner]];
  const bool isTouchable = blueprint.topology.isOpen || area.dot(across) < 0;  // from behind, too; or convex
  return isTouchable && area.dot(other) < kSharpCosine * area.norm() * other.norm();
}

// Blueprint::sharpEdges and sharpWings.
void FindSharpEdges(Blueprint& blueprint) {
  blueprint.sharpEdges.clear();
  blueprint.sharpWings.clear();
  for (std::size_t f = 0; f < blueprint.topology.neighbours.size(); ++f) {
    const Face& face = blueprint.full.faces[f];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (!IsSharp(blueprint, f, corner)) continue;
      blueprint.sharpEdges.push_back({face[(corner + 1) % 3], face[(corner + 2) % 3]});
      blueprint.sharpWings.push_back({face[corner], blueprint.topology.across[f][corner]});
    }
  }
}

// Blueprint::sideLength.
double FindSideLength(const Blueprint& blueprint) {
  const std::vector<EdgeEnds>& sides = blueprint.topology.sides;
  double length = 0;
  for (const auto& [a, b] : sides) length += (blueprint.rest[a] - blueprint.rest[b]).norm();
  return sides.empty() ? 0 : length / static_cast<double>(sides.size());
}

// Blueprint::selfEdges.
void FindSelfEdges(Blueprint& blueprint) {
  blueprint.selfEdges = blueprint.edges;
  blueprint.selfRadius = blueprint.edgeRadius;
  if (blueprint.edges.empty() && blueprint.full.gas <= 0 && blueprint.sideLength > 0) {
    blueprint.selfRadius = kSelfRadiusShare * blueprint.sideLength;
    for (const std::uint16_t vertex : FindOuterVertices(blueprint)) blueprint.selfEdges.push_back({vertex, vertex});
  }
  const bool isSmall = blueprint.reach <= kSelfApartShare * blueprint.selfRadius;  // so that nothing in it is apart
  if (isSmall || blueprint.selfEdges.size() < 2) blueprint.selfRadius = 0;
}

bool IsClosed(const Topology& topology) {
  return !topology.neighbours.empty() && std::ranges::none_of(topology.neighbours, [](const auto& sides) {
    return std::ranges::any_of(sides, [](std::uint16_t face) { return face == kNoFace; });
  });
}

double FindRestVolume(const Blueprint& blueprint) {
  const Coefficients<double>& full = blueprint.full;
  if (!full.outline.empty()) return ComputeArea<double>(full.outline, blueprint.rest);
  return IsClosed(blueprint.topology) ? ComputeVolume<double>(full.faces, blueprint.rest) : 0;
}

// Blueprint::coreRadius.
double FindCoreRadius(const Blueprint& blueprint) {
  if (blueprint.full.planar || blueprint.topology.isOpen) return 0;
  double radius = blueprint.reach;
  for (const Face& face : blueprint.full.faces) {
    const Vector3d& a = blueprint.rest[face[0]];
    const Vector3d area = (blueprint.rest[face[1]] - a).cross(blueprint.rest[face[2]] - a);
    const double doubleArea = area.norm();
    if (doubleArea > 0) radius = std::min(radius, area.dot(a) / doubleArea);
  }
  return std::max(0.0, radius);
}

// The largest drag rate of a vertex, 1/m. A face of area A that meets the medium at speed u adds 2 (½ρC) A |u| to the
// damping of its motion, a third at each vertex.
double FindDragRate(const Blueprint& blueprint) {
  const Coefficients<double>& full = blueprint.full;
  if (!(full.drag > 0)) return 0;
  std::vector<double> areas(blueprint.rest.size(), 0);
  for (const Face& face : full.faces) {
    const Vector3d& a = blueprint.rest[face[0]];
    const double area = (blueprint.rest[face[1]] - a).cross(blueprint.rest[face[2]] - a).norm() / 2;
    for (const std::uint16_t vertex : face) areas[vertex] += area / 3;
  }
  double rate = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) rate = std::max(rate, 2 * full.drag * areas[i] / full.masses[i]);
  return rate;
}

// c_g with which the volume, held by the gas alone, dies out at gasDampingRatio ζ: 2ζω = c_g γ with γ = Σ |∂V/∂xᵢ|²/mᵢ
// and ω² = γ nRT/V². Planar: with the area.
double FindGasViscosity(const Blueprint& blueprint) {
  const Coefficients<double>& full = blueprint.full;
  if (!(full.gas > 0) || !(blueprint.restVolume > 0)) return 0;
  Coefficients<double> alone = full;  // of a pressure of 1 Pa, of which the force is the gradient
  alone.gas = blueprint.restVolume;
  alone.ambientPressure = 0;
  alone.floorVolume = 0;
  std::vector<Vector3d> gradient(blueprint.rest.size(), Vector3d::Zero());
  AddGas<double>(alone, 1, blueprint.rest, gradient);
  double perMass = 0;
  for (std::size_t i = 0; i < gradient.size(); ++i) perMass += gradient[i].squaredNorm() * full.inverseMasses[i];
  return perMass > 0 ? 2 * blueprint.gasDampingRatio * std::sqrt(full.gas / perMass) / blueprint.restVolume : 0;
}

}  // namespace

void CheckField(std::vector<FieldError>& errors, const char* field, double value, bool valid, const char* range) {
  if (valid) return;
  std::string text = std::to_string(value);
  errors.push_back({field, text.erase(text.find_last_not_of('0') + 1).append(text.back() == '.' ? "0" : ""), range});
}

bool IsSlowEnough(const Blueprint& blueprint) {
  const double rate = std::max(blueprint.angularFrequency, blueprint.dampingRate);
  return rate / kTickHz / kStabilityLimit <= kMaxSubsteps / 2 &&
         FindSubstepsOnGround(blueprint, 1 / kTickHz) <= kMaxSubsteps;
}

void SetIntegrator(Blueprint& blueprint, Integrator integrator) {
  blueprint.integrator = integrator;
  blueprint.sparsePattern.reset();
  assert((blueprint.full.tetrahedra.empty() && blueprint.full.hinges.empty()) ||
         (integrator != Integrator::kImplicitEuler && integrator != Integrator::kPositionVerlet));
  if (integrator != Integrator::kImplicitEuler) return;
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const Spring<double>& spring : blueprint.full.springs) pairs.push_back({spring.a, spring.b});
  blueprint.sparsePattern = std::make_shared<SparsePattern>(MakeSparsePattern(pairs, blueprint.rest.size()));
}

void SetCells(Blueprint& blueprint, Cells<double> cells) {
  blueprint.full.cells = std::move(cells);
  blueprint.single.cells = ToSingle(blueprint.full.cells);
}

void SetAim(Blueprint& blueprint, bool afterInsideOut) {
  // Of the square of the body's largest frequency. The aim is farther than an edge is long, so less than 1 overcomes
  // what holds a fold: of 400 broken rings of several layers 338 came back with 0.03, 390 with 0.1 and 393 with 0.3,
  // when rings that are too soft to carry themselves were still accepted.
  constexpr double kShare = 0.3;
  const double squareFrequency = kShare * blueprint.angularFrequency * blueprint.angularFrequency;
  // Critical, but for half of what the other terms leave of the rate that kMaxSubsteps can hold at most.
  const double room = kTickHz * kMaxSubsteps * kStabilityLimit - blueprint.dampingRate - blueprint.full.cells.damping;
  const double damping = std::min(2 * std::sqrt(squareFrequency), std::max(0.0, room / 2));
  blueprint.full.aim = {
      .rest = blueprint.rest, .squareFrequency = squareFrequency, .damping = damping, .afterInsideOut = afterInsideOut};
  blueprint.single.aim = blueprint.full.aim;
}

void SetContactLaw(Blueprint& blueprint, ContactLaw law, double magneticStrength) {
  ContactParameters<double>& contact = blueprint.full.contact;
  contact.law = law;
  contact.range = law == ContactLaw::kBacktracking ? kBacktrackingRange : 0;
  if (law == ContactLaw::kMagnetic) {
    const std::vector<double>& masses = blueprint.full.masses;
    FillMagneticLaw(contact, magneticStrength, *std::max_element(masses.begin(), masses.end()));
  }
  blueprint.single.contact = ToSingle(contact);
}

void FinishBlueprintButStability(Blueprint& blueprint) {
  const std::vector<double>& masses = blueprint.full.masses;
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < masses.size(); ++i) {
    mass += masses[i];
    moment += masses[i] * blueprint.rest[i];
  }
  const Vector3d centre = moment / mass;
  for (Vector3d& x : blueprint.rest) x -= centre;
  FinishCentredBlueprint(blueprint);
}

void FinishCentredBlueprint(Blueprint& blueprint) {
  Coefficients<double>& full = blueprint.full;
  blueprint.totalMass = 0;
  full.inverseMasses.resize(full.masses.size());
  for (std::size_t i = 0; i < full.masses.size(); ++i) {
    full.inverseMasses[i] = 1 / full.masses[i];
    blueprint.totalMass += full.masses[i];
  }
  for (const std::uint16_t vertex : full.fixed) full.inverseMasses[vertex] = 0;

  double squares = 0;
  blueprint.reach = kMinSize;
  for (const Vector3d& x : blueprint.rest) {
    squares += x.squaredNorm();
    blueprint.reach = std::max(blueprint.reach, x.norm());
  }
  blueprint.size = std::max(kMinSize, std::sqrt(squares / static_cast<double>(blueprint.rest.size())));
  blueprint.topology = MakeTopology(full.faces, blueprint.rest.size());
  blueprint.restVolume = FindRestVolume(blueprint);
  blueprint.coreRadius = FindCoreRadius(blueprint);
  full.floorVolume = kFloorVolumeShare * blueprint.restVolume;
  blueprint.gasViscosity = FindGasViscosity(blueprint);
  blueprint.dragRate = FindDragRate(blueprint);
  FindContactShares(blueprint);
  FindEdges(blueprint);
  FindSharpEdges(blueprint);
  blueprint.sideLength = FindSideLength(blueprint);
  FindSelfEdges(blueprint);
  blueprint.single = ToSingle(full);
  MakePlans(blueprint);
}

void MakePlans(Blueprint& blueprint) {
  blueprint.singlePlan = MakeSweepPlan(blueprint.single, blueprint.grid);
  blueprint.fullPlan = MakeSweepPlan(blueprint.full, blueprint.grid);
  blueprint.singleGridPlan = MakeGridPlan(blueprint.single, blueprint.grid);
  blueprint.fullGridPlan = MakeGridPlan(blueprint.full, blueprint.grid);
}

void FinishBlueprint(Blueprint& blueprint) {
  FinishBlueprintButStability(blueprint);
  FindBodyStability(blueprint);
}

}  // namespace wobble::physics
