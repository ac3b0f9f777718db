#include "server/physics/lanes/sweep_plan.h"

#include <algorithm>
#include <array>
#include <bit>

#include "server/physics/blueprint.h"

namespace wobble::physics {
namespace {

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
void FillArcs(const Coefficients<Real>& body, const std::vector<std::uint32_t>& places, SweepPlan<Real>& plan) {
  std::vector<std::vector<Arc<Real>>> arcs(places.size());
  std::uint32_t reach = 0;
  for (const Spring<Real>& spring : body.springs) {
    const auto [first, last] = std::minmax(places[spring.a], places[spring.b]);
    reach = std::max(reach, last - first);
    arcs[first].push_back({last, spring.stiffness, spring.stiffness * spring.restLength, spring.damping});
  }
  plan.pendingMask = std::bit_ceil(reach + 1) - 1;
  for (const std::vector<Arc<Real>>& own : arcs) {
    plan.arcBegins.push_back(static_cast<std::uint32_t>(plan.arcs.size()));
    plan.arcs.insert(plan.arcs.end(), own.begin(), own.end());
  }
  plan.arcBegins.push_back(static_cast<std::uint32_t>(plan.arcs.size()));
}

// A closed surface has each edge a → b in one face, so the faces round a vertex follow from one another. Where several
// such rounds meet in one vertex, each is closed and the way leads on to the next: what is crossed between two of them
// is crossed back at the end, and adds nothing.
std::vector<std::uint32_t> FindRing(std::vector<std::array<std::uint32_t, 2>> wedges) {
  std::vector<std::uint32_t> ring;
  for (std::size_t rounds = 0; !wedges.empty(); ++rounds) {
    const std::uint32_t first = wedges[0][0];
    for (std::uint32_t at = first;;) {
      const auto wedge = std::find_if(wedges.begin(), wedges.end(), [at](const auto& each) { return each[0] == at; });
      if (wedge == wedges.end()) break;
      ring.push_back(at);
      at = (*wedge)[1];
      wedges.erase(wedge);
    }
    if (rounds > 0 || !wedges.empty()) ring.push_back(first);
  }
  return ring;
}

template <class Real>
void FillRings(const Coefficients<Real>& body, const std::vector<std::uint32_t>& places, SweepPlan<Real>& plan) {
  std::vector<std::vector<std::array<std::uint32_t, 2>>> wedges(places.size());
  for (const Face& face : body.faces) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      wedges[places[face[corner]]].push_back({places[face[(corner + 1) % 3]], places[face[(corner + 2) % 3]]});
    }
  }
  for (const auto& own : wedges) {
    plan.ringBegins.push_back(static_cast<std::uint32_t>(plan.ring.size()));
    const std::vector<std::uint32_t> ring = FindRing(own);
    plan.ring.insert(plan.ring.end(), ring.begin(), ring.end());
  }
  plan.ringBegins.push_back(static_cast<std::uint32_t>(plan.ring.size()));
}

template <class Real>
void FillFaces(const Coefficients<Real>& body, const std::vector<std::uint32_t>& places, SweepPlan<Real>& plan) {
  Lists others(places.size());
  for (const Face& face : body.faces) {
    const std::array<std::uint32_t, 3> at{places[face[0]], places[face[1]], places[face[2]]};
    const std::size_t last = std::max_element(at.begin(), at.end()) - at.begin();
    others[at[last]].push_back(at[(last + 1) % 3]);
    others[at[last]].push_back(at[(last + 2) % 3]);
  }
  for (const std::vector<std::uint32_t>& own : others) {
    plan.faceBegins.push_back(static_cast<std::uint32_t>(plan.faces.size()));
    plan.faces.insert(plan.faces.end(), own.begin(), own.end());
  }
  plan.faceBegins.push_back(static_cast<std::uint32_t>(plan.faces.size()));
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
  for (const std::uint16_t vertex : plan.vertices) plan.inverseMasses.push_back(body.inverseMasses[vertex]);
  FillArcs(body, plan.places, plan);
  plan.planar = body.planar;
  plan.hasGas = body.gas > Real(0) && body.outline.empty();
  if (plan.hasGas) {
    FillRings(body, plan.places, plan);
    FillFaces(body, plan.places, plan);
    plan.ambientPressure = body.ambientPressure;
    plan.floorVolume = body.floorVolume;
  }
  return plan;
}

template SweepPlan<float> MakeSweepPlan<float>(const Coefficients<float>&);
template SweepPlan<double> MakeSweepPlan<double>(const Coefficients<double>&);

}  // namespace wobble::physics
