// Orders vertices and springs for the sweep, and turns faces into rings and wedges (kernels/sweep_tables.h), so that
// the sweep reads all tables once, front to back. Every index is multiplied out here: 6 times a place, 3 times a slot.
#include "server/physics/model/sweep_plan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {
namespace {

using Edge = std::array<std::uint32_t, 2>;
using Lists = std::vector<std::vector<std::uint32_t>>;

template <class Real>
Lists FindNeighbours(const Coefficients<Real>& body) {
  Lists neighbours(body.masses.size());
  for (const Spring<Real>& spring : body.springs) {
    neighbours[spring.a].push_back(spring.b);
    neighbours[spring.b].push_back(spring.a);
  }
  for (const Tetrahedron<Real>& element : body.tetrahedra) {
    for (const std::uint16_t a : element.vertices) {
      for (const std::uint16_t b : element.vertices) {
        if (a != b) neighbours[a].push_back(b);
      }
    }
  }
  return neighbours;
}

// Breadth-first order, from the first vertex of each connected component.
std::vector<std::uint16_t> FindOrder(const Lists& neighbours) {
  std::vector<std::uint16_t> order;
  std::vector<bool> found(neighbours.size(), false);
  for (std::size_t first = 0; first < neighbours.size(); ++first) {
    if (found[first]) continue;
    found[first] = true;
    order.push_back(static_cast<std::uint16_t>(first));
    for (std::size_t at = order.size() - 1; at < order.size(); ++at) {
      for (const std::uint32_t next : neighbours[order[at]]) {
        if (found[next]) continue;
        found[next] = true;
        order.push_back(static_cast<std::uint16_t>(next));
      }
    }
  }
  return order;
}

std::vector<std::uint16_t> ListNumbers(std::size_t count) {
  std::vector<std::uint16_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::uint16_t{0});
  return numbers;
}

template <class Real>
void FillArcs(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  Lists springs(plan.at.size());
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) {
    springs[std::min(plan.places[body.springs[i].a], plan.places[body.springs[i].b])].push_back(i);
  }
  for (std::uint32_t place = 0; place < springs.size(); ++place) {
    const auto otherOf = [&](std::uint32_t i) {
      return std::max(plan.places[body.springs[i].a], plan.places[body.springs[i].b]);
    };
    std::ranges::stable_sort(springs[place], {}, otherOf);
    for (const std::uint32_t i : springs[place]) {
      const Spring<Real>& spring = body.springs[i];
      const std::uint32_t other = otherOf(i);
      plan.arcs.push_back({.other = 6 * other,
                           .pending = 3 * (other & plan.pendingMask),
                           .stiffness = spring.stiffness,
                           .stiffnessAtRest = spring.stiffness * spring.restLength,
                           .damping = spring.damping});
      plan.springs.push_back(i);
      plan.repulsionFloors.push_back(static_cast<Real>(kRepulsionFloorShare) * spring.restLength);
      plan.arcEnds.insert(plan.arcEnds.end(), {6 * place, 6 * other});
    }
    plan.at[place].arcEnd = static_cast<std::uint32_t>(plan.arcs.size());
  }
}

// The largest number of places that a force is passed on by, from springs, tetrahedra, hinges and, if the body has
// drag, faces.
template <class Real>
std::uint32_t FindReach(const Coefficients<Real>& body, const std::vector<std::uint32_t>& places) {
  std::uint32_t reach = 0;
  const auto extend = [&](std::uint32_t a, std::uint32_t b) {
    reach = std::max(reach, std::max(places[a], places[b]) - std::min(places[a], places[b]));
  };
  for (const Spring<Real>& spring : body.springs) extend(spring.a, spring.b);
  for (const Tetrahedron<Real>& element : body.tetrahedra) {
    for (std::size_t i = 1; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) extend(element.vertices[i], element.vertices[j]);
    }
  }
  for (const Hinge<Real>& hinge : body.hinges) extend(hinge.vertices.front(), hinge.vertices.back());
  if (!(body.drag > Real(0))) return reach;
  for (const Face& face : body.faces) {
    for (std::size_t corner = 0; corner < 3; ++corner) extend(face[corner], face[(corner + 1) % 3]);
  }
  return reach;
}

template <class Real>
void FillDraggedFaces(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  std::vector<std::vector<DraggedFace>> faces(plan.at.size());
  for (const Face& face : body.faces) {
    if (!(body.drag > Real(0))) break;
    const std::array<std::uint32_t, 3> at{plan.places[face[0]], plan.places[face[1]], plan.places[face[2]]};
    const std::size_t first = std::min_element(at.begin(), at.end()) - at.begin();
    const std::uint32_t b = at[(first + 1) % 3];
    const std::uint32_t c = at[(first + 2) % 3];
    faces[at[first]].push_back({{6 * b, 6 * c}, {3 * (b & plan.pendingMask), 3 * (c & plan.pendingMask)}});
  }
  for (const std::vector<DraggedFace>& own : faces) {
    plan.draggedFaces.insert(plan.draggedFaces.end(), own.begin(), own.end());
    plan.draggedEnds.push_back(static_cast<std::uint32_t>(plan.draggedFaces.size()));
  }
}

// first: the corner with the first place.
template <class Real>
Element<Real> MakeElement(const Tetrahedron<Real>& tetrahedron, const SolidMaterial<Real>& material,
                          const SweepPlan<Real>& plan, std::size_t first) {
  const auto gradientOf = [&](std::size_t corner, std::size_t axis) {
    const auto& g = tetrahedron.gradients;
    return corner > 0 ? g[corner - 1][axis] : -(g[0][axis] + g[1][axis] + g[2][axis]);
  };
  Element<Real> element{.shear = tetrahedron.volume * material.shear,
                        .bulk = tetrahedron.volume * material.bulk,
                        .viscosity = tetrahedron.volume * material.viscosity};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t corner = (first + 1 + i) % 4;
    const std::uint32_t place = plan.places[tetrahedron.vertices[corner]];
    element.others[i] = 6 * place;
    element.pending[i] = 3 * (place & plan.pendingMask);
    for (std::size_t axis = 0; axis < 3; ++axis) element.gradients[i][axis] = gradientOf(corner, axis);
  }
  return element;
}

template <class Real>
void FillElementColumns(SweepPlan<Real>& plan) {
  const std::size_t padded = (plan.elements.size() + kArcsAtOnce - 1) / kArcsAtOnce * kArcsAtOnce;
  plan.elementCorners.assign(3 * 2 * padded, 0);
  plan.elementNumbers.assign(kElementNumbers * padded, 0);
  std::uint32_t place = 0;
  for (std::size_t e = 0; e < plan.elements.size(); ++e) {
    while (plan.elementEnds[place] <= e) ++place;
    const Element<Real>& element = plan.elements[e];
    for (std::size_t i = 0; i < 3; ++i) {
      plan.elementCorners[2 * (i * padded + e)] = element.others[i];
      plan.elementCorners[2 * (i * padded + e) + 1] = 6 * place;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        plan.elementNumbers[(3 * i + axis) * padded + e] = element.gradients[i][axis];
      }
    }
    plan.elementNumbers[9 * padded + e] = element.shear;
    plan.elementNumbers[10 * padded + e] = element.bulk;
    plan.elementNumbers[11 * padded + e] = element.viscosity;
  }
  for (const std::uint32_t corner : plan.elementCorners) plan.elementVertices.push_back(3U * plan.vertices[corner / 6]);
}

template <class Real>
void FillElements(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  plan.restRatio = body.solid.restRatio;
  std::vector<std::vector<Element<Real>>> elements(plan.at.size());
  for (const Tetrahedron<Real>& tetrahedron : body.tetrahedra) {
    const auto placeOf = [&](std::uint16_t vertex) { return plan.places[vertex]; };
    const std::size_t first =
        std::ranges::min_element(tetrahedron.vertices, {}, placeOf) - tetrahedron.vertices.begin();
    elements[plan.places[tetrahedron.vertices[first]]].push_back(MakeElement(tetrahedron, body.solid, plan, first));
  }
  for (const std::vector<Element<Real>>& own : elements) {
    plan.elements.insert(plan.elements.end(), own.begin(), own.end());
    plan.elementEnds.push_back(static_cast<std::uint32_t>(plan.elements.size()));
  }
  FillElementColumns(plan);
}

template <class Real>
void FillHinges(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  plan.hingeFloorSquare = body.hingeFloorSquare;
  std::vector<std::vector<HingeArc<Real>>> hinges(plan.at.size());
  for (const Hinge<Real>& hinge : body.hinges) {
    HingeArc<Real> arc{.stiffness = hinge.stiffness, .damping = hinge.damping};
    const std::uint32_t first = plan.places[hinge.vertices[0]];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t place = plan.places[hinge.vertices[i + 1]];
      assert(place > first && place <= plan.places[hinge.vertices[3]]);
      arc.others[i] = 6 * place;
      arc.pending[i] = 3 * (place & plan.pendingMask);
    }
    hinges[first].push_back(arc);
  }
  for (const std::vector<HingeArc<Real>>& own : hinges) {
    plan.hinges.insert(plan.hinges.end(), own.begin(), own.end());
    plan.hingeEnds.push_back(static_cast<std::uint32_t>(plan.hinges.size()));
  }
}

// Rings and wedges of an outline. A place's ring has the far ends of the two edges that meet there; its wedge has those
// of them that come before the place.
template <class Real>
void FillOutline(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  Lists before(plan.at.size());
  Lists after(plan.at.size());
  for (const auto& [a, b] : body.outline) {
    after[plan.places[a]].push_back(plan.places[b]);
    before[plan.places[b]].push_back(plan.places[a]);
  }
  for (std::uint32_t place = 0; place < plan.at.size(); ++place) {
    for (std::size_t i = 0; i < std::max(before[place].size(), after[place].size()); ++i) {
      const std::uint32_t from = i < before[place].size() ? before[place][i] : place;
      const std::uint32_t to = i < after[place].size() ? after[place][i] : place;
      plan.ring.insert(plan.ring.end(), {6 * from, 6 * to});
      if (from >= place && to >= place) continue;
      plan.wedges.push_back({.last = 6 * place,
                             .before = 6 * std::min(from, place),
                             .middle = 6 * place,
                             .after = 6 * std::min(to, place)});
    }
    plan.at[place].ringEnd = static_cast<std::uint32_t>(plan.ring.size());
    plan.at[place].wedgeEnd = static_cast<std::uint32_t>(plan.wedges.size());
  }
}

template <class Real>
void FillColumns(SweepPlan<Real>& plan) {
  for (const Arc<Real>& arc : plan.arcs) {
    plan.stiffnesses.push_back(arc.stiffness);
    plan.stiffnessesAtRest.push_back(arc.stiffnessAtRest);
    plan.dampings.push_back(arc.damping);
  }
  const std::size_t whole = (plan.arcs.size() + kArcsAtOnce - 1) / kArcsAtOnce * kArcsAtOnce;
  plan.arcEnds.resize(2 * whole);
  for (auto* column : {&plan.stiffnesses, &plan.stiffnessesAtRest, &plan.dampings}) column->resize(whole);
}

// A closed skin has each edge a → b in one face, so the faces round a vertex follow from one another. If several such
// rounds meet in one vertex, each is closed and the path goes on to the next; the steps between two rounds are taken
// back at the end and add nothing to the sum.
std::vector<std::uint32_t> FindRing(std::vector<Edge> edges) {
  std::vector<std::uint32_t> ring;
  for (std::size_t rounds = 0; !edges.empty(); ++rounds) {
    const std::uint32_t first = edges[0][0];
    for (std::uint32_t at = first;;) {
      const auto edge = std::find_if(edges.begin(), edges.end(), [at](const auto& each) { return each[0] == at; });
      if (edge == edges.end()) break;
      ring.push_back(at);
      at = (*edge)[1];
      edges.erase(edge);
    }
    if (rounds > 0 || !edges.empty()) ring.push_back(first);
  }
  return ring;
}

template <class Real>
void FillRings(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  const std::vector<std::uint32_t>& places = plan.places;
  std::vector<std::vector<Edge>> edges(places.size());
  for (const Face& face : body.faces) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      edges[places[face[corner]]].push_back({places[face[(corner + 1) % 3]], places[face[(corner + 2) % 3]]});
    }
  }
  for (std::size_t place = 0; place < edges.size(); ++place) {
    std::vector<std::uint32_t> ring = FindRing(edges[place]);
    if (ring.size() % 2 == 1) ring.push_back(ring.back());  // the same place twice adds nothing
    for (const std::uint32_t other : ring) plan.ring.push_back(6 * other);
    plan.at[place].ringEnd = static_cast<std::uint32_t>(plan.ring.size());
  }
}

// Removes a path from `edges` and returns its vertices. It begins at an edge that no other leads to, if there is one.
std::vector<std::uint32_t> TakePath(std::vector<Edge>& edges) {
  const auto isFirst = [&edges](const Edge& edge) {
    return std::none_of(edges.begin(), edges.end(), [&edge](const Edge& each) { return each[1] == edge[0]; });
  };
  const auto first = std::find_if(edges.begin(), edges.end(), isFirst);
  std::vector<std::uint32_t> path{first == edges.end() ? edges[0][0] : (*first)[0]};
  for (;;) {
    const auto next =
        std::find_if(edges.begin(), edges.end(), [&](const Edge& each) { return each[0] == path.back(); });
    if (next == edges.end()) return path;
    path.push_back((*next)[1]);
    edges.erase(next);
  }
}

template <class Real>
void FillWedges(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  std::vector<std::vector<Edge>> edges(plan.at.size());  // opposite the last place of each face
  for (const Face& face : body.faces) {
    const std::array<std::uint32_t, 3> at{plan.places[face[0]], plan.places[face[1]], plan.places[face[2]]};
    const std::size_t last = std::max_element(at.begin(), at.end()) - at.begin();
    edges[at[last]].push_back({at[(last + 1) % 3], at[(last + 2) % 3]});
  }
  for (std::uint32_t place = 0; place < edges.size(); ++place) {
    while (!edges[place].empty()) {
      const std::vector<std::uint32_t> path = TakePath(edges[place]);
      for (std::size_t i = 1; i < path.size(); i += 2) {
        const std::uint32_t after = path[std::min(i + 1, path.size() - 1)];
        plan.wedges.push_back(
            {.last = 6 * place, .before = 6 * path[i - 1], .middle = 6 * path[i], .after = 6 * after});
      }
    }
    plan.at[place].wedgeEnd = static_cast<std::uint32_t>(plan.wedges.size());
  }
}

}  // namespace

template <class Real>
SweepPlan<Real> MakeSweepPlan(const Coefficients<Real>& body, const GridShape& grid) {
  SweepPlan<Real> plan;
  plan.vertices = grid.columns > 0 ? ListNumbers(body.masses.size()) : FindOrder(FindNeighbours(body));
  plan.places.resize(plan.vertices.size());
  for (std::uint32_t place = 0; place < plan.places.size(); ++place) plan.places[plan.vertices[place]] = place;
  for (const std::uint16_t vertex : plan.vertices) plan.at.push_back({.inverseMass = body.inverseMasses[vertex]});
  plan.pendingMask = std::bit_ceil(FindReach(body, plan.places) + 1) - 1;
  FillArcs(body, plan);
  FillColumns(plan);
  FillDraggedFaces(body, plan);
  if (!body.tetrahedra.empty()) FillElements(body, plan);
  if (!body.hinges.empty()) FillHinges(body, plan);
  plan.planar = body.planar;
  plan.hasGas = body.gas > Real(0) && body.outline.empty();
  plan.hasOutline = body.gas > Real(0) && !body.outline.empty();
  if (plan.hasGas) {
    FillRings(body, plan);
    FillWedges(body, plan);
  }
  if (plan.hasOutline) FillOutline(body, plan);
  plan.ambientPressure = body.ambientPressure;
  plan.floorVolume = body.floorVolume;
  plan.repulsion = body.repulsion;
  plan.dragShare = body.drag / Real(6);
  plan.tears = body.tearStretch > Real(0);
  plan.isSolid = !plan.elements.empty() && plan.arcs.empty() && !(body.gas > Real(0)) && !(body.drag > Real(0));
  plan.isRare = !plan.elements.empty() || !plan.hinges.empty() || plan.hasOutline || plan.tears ||
                body.repulsion > Real(0) || body.drag > Real(0);
  return plan;
}

template SweepPlan<float> MakeSweepPlan<float>(const Coefficients<float>&, const GridShape&);
template SweepPlan<double> MakeSweepPlan<double>(const Coefficients<double>&, const GridShape&);

}  // namespace wobble::physics
