#include "tests/bench/capacity/contacts.h"

#include <algorithm>
#include <numeric>

namespace wobble::bench {
namespace {

double Divide(std::size_t sum, std::size_t count) {
  return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0;
}

}  // namespace

std::size_t Contacts::FindRoot(std::size_t place) {
  while (m_others[place] != place) place = m_others[place] = m_others[m_others[place]];
  return place;
}

void Contacts::Look(const physics::World& world) {
  const auto bodies = world.Bodies();
  m_others.resize(bodies.size());
  std::iota(m_others.begin(), m_others.end(), std::size_t{0});
  for (std::size_t place = 0; place < bodies.size(); ++place) {
    world.ListTouching(bodies[place].id, m_touched);
    m_touches += m_touched.size();
    m_touching += m_touched.empty() ? 0 : 1;
    for (const physics::BodyId other : m_touched) {
      const auto found = std::ranges::lower_bound(bodies, other, {}, &physics::Body::id);
      m_others[FindRoot(static_cast<std::size_t>(found - bodies.begin()))] = FindRoot(place);
    }
  }
  m_sizes.assign(bodies.size(), 0);
  for (std::size_t place = 0; place < bodies.size(); ++place) ++m_sizes[FindRoot(place)];
  std::size_t largest = 0;
  for (const std::size_t size : m_sizes) {
    largest = std::max(largest, size);
    if (size >= kDozen) m_inLargeIslands += size;
  }
  ++m_looks;
  m_bodies += bodies.size();
  m_largest += largest;
  m_largestEver = std::max(m_largestEver, largest);
}

double Contacts::Touching() const { return Divide(m_touching, m_looks); }
double Contacts::TouchedByEach() const { return Divide(m_touches, m_bodies); }
double Contacts::LargestIsland() const { return Divide(m_largest, m_looks); }
double Contacts::ShareInLargeIslands() const { return Divide(m_inLargeIslands, m_bodies); }

}  // namespace wobble::bench
