#include "server/physics/lanes/sweep_plan.h"

#include <algorithm>
#include <array>
#include <bit>

#include "server/physics/blueprint.h"

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
  return neighbours;
}

// Breadth first, from the first vertex of each part that hangs together.
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

template <class Real>
void FillArcs(const Coefficients<Real>& body, SweepPlan<Real>& plan) {
  std::vector<std::vector<Arc<Real>>> arcs(plan.at.size());
  std::uint32_t reach = 0;
  for (const Spring<Real>& spring : body.springs) {
    const auto [first, last] = std::minmax(plan.places[spring.a], plan.places[spring.b]);
    reach = std::max(reach, last - first);
    arcs[first].push_back({last, 0, spring.stiffness, spring.stiffness * spring.restLength, spring.damping});
  }
  plan.pendingMask = std::bit_ceil(reach + 1) - 1;
  for (std::uint32_t place = 0; place < arcs.size(); ++place) {
    for (Arc<Real>& arc : arcs[place]) {
      arc.pending = 3 * (arc.other & plan.pendingMask);
      arc.other *= 6;
      plan.arcs.push_back(arc);
      plan.arcEnds.insert(plan.arcEnds.end(), {6 * place, arc.other});
    }
    plan.at[place].arcEnd = static_cast<std::uint32_t>(plan.arcs.size());
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

// A closed surface has each edge a → b in one face, so the faces round a vertex follow from one another. Where several
// such rounds meet in one vertex, each is closed and the way leads on to the next: what is crossed between two of them
// is crossed back at the end, and adds nothing.
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
    if (ring.size() % 2 == 1) ring.push_back(ring.back());  // twice in one place: nothing lies between
    for (const std::uint32_t other : ring) plan.ring.push_back(6 * other);
    plan.at[place].ringEnd = static_cast<std::uint32_t>(plan.ring.size());
  }
}

// Takes an edge that none leads to, if there is one, and those that go on from it.
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
        plan.wedges.push_back({6 * place, 6 * path[i - 1], 6 * path[i], 6 * after});
      }
    }
    plan.at[place].wedgeEnd = static_cast<std::uint32_t>(plan.wedges.size());
  }
}

}  // namespace

template <class Real>
SweepPlan<Real> MakeSweepPlan(const Coefficients<Real>& body) {
  SweepPlan<Real> plan;
  const bool isTooMuch = body.repulsion > Real(0) || body.drag > Real(0) || body.tearStretch > Real(0) ||
                         (body.gas > Real(0) && !body.outline.empty());
  if (isTooMuch) return plan;
  plan.vertices = FindOrder(FindNeighbours(body));
  plan.places.resize(plan.vertices.size());
  for (std::uint32_t place = 0; place < plan.places.size(); ++place) plan.places[plan.vertices[place]] = place;
  for (const std::uint16_t vertex : plan.vertices) plan.at.push_back({body.inverseMasses[vertex], 0, 0, 0});
  FillArcs(body, plan);
  FillColumns(plan);
  plan.planar = body.planar;
  plan.hasGas = body.gas > Real(0) && body.outline.empty();
  if (plan.hasGas) {
    FillRings(body, plan);
    FillWedges(body, plan);
    plan.ambientPressure = body.ambientPressure;
    plan.floorVolume = body.floorVolume;
  }
  return plan;
}

template SweepPlan<float> MakeSweepPlan<float>(const Coefficients<float>&);
template SweepPlan<double> MakeSweepPlan<double>(const Coefficients<double>&);

}  // namespace wobble::physics
