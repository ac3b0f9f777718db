// A slot is a place and a plane that any body of the pack may touch there; it has a number for every lane. Lanes
// without that contact get an offset far below, so that the kernel needs no mask.
#include "server/physics/packs/pack_planes.h"

#include <algorithm>

namespace wobble::physics {
namespace {

// Numbers of a slot for each lane: offset, share, stick and three of the anchor.
constexpr std::size_t kNumbers = 6;
// Planes that a body usually touches at once. With more the lists grow, which allocates.
constexpr std::size_t kLikelyPlanes = 2;
// Offset of a plane that no vertex reaches, m; its square is still finite in float.
constexpr float kFarBelow = -1e15F;

}  // namespace

template <class Real>
void PackPlanes<Real>::Reserve(std::size_t vertices) {
  constexpr std::size_t kWidest = 64 / sizeof(float);
  m_entries.reserve(kLikelyPlanes * kWidest * vertices);
  m_slots.reserve(kLikelyPlanes * vertices);
  m_surfaces.reserve(16);
  m_slotOf.reserve(8 * vertices);
  m_numbers.reserve(kLikelyPlanes * vertices * kNumbers * kWidest * sizeof(Real) / sizeof(Line) + 1);
}

template <class Real>
void PackPlanes<Real>::Clear(const Coefficients<Real>& body, std::size_t places, std::size_t width) {
  m_body = &body;
  m_places = places;
  m_width = width;
  m_entries.clear();
  m_slots.clear();
  m_surfaces.clear();
  m_slotOf.clear();
}

template <class Real>
std::uint32_t PackPlanes<Real>::FindSlot(std::uint32_t place, std::uint32_t surface, const Surface<Real>& plane) {
  const auto known = std::find(m_surfaces.begin(), m_surfaces.end(), surface);
  const auto row = static_cast<std::size_t>(known - m_surfaces.begin());
  if (known == m_surfaces.end()) {
    m_surfaces.push_back(surface);
    m_slotOf.resize(m_slotOf.size() + m_places, 0);
  }
  std::uint32_t& slot = m_slotOf[row * m_places + place];
  if (slot == 0) {
    m_slots.push_back(
        {place, {plane.normal[0], plane.normal[1], plane.normal[2]}, m_body->contact.friction * plane.friction});
    slot = static_cast<std::uint32_t>(m_slots.size());
  }
  return slot - 1;
}

template <class Real>
void PackPlanes<Real>::Add(const PackSeat& seat, const Surface<Real>& plane, Contact<Real>& contact) {
  m_entries.push_back(
      {.slot = FindSlot(seat.place, contact.surface, plane), .lane = seat.lane, .plane = &plane, .contact = &contact});
}

template <class Real>
void PackPlanes<Real>::Close() {
  const std::size_t count = m_slots.size() * m_width;
  constexpr std::size_t kInLine = 64 / sizeof(Real);
  m_numbers.assign((kNumbers * count + kInLine - 1) / kInLine, {});
  const PlaneLanes<Real> lanes = Lanes();
  std::fill_n(lanes.offsets, count, static_cast<Real>(kFarBelow));
  for (const Entry& entry : m_entries) {
    const std::size_t at = entry.slot * m_width + entry.lane;
    lanes.offsets[at] = entry.plane->offset;
    lanes.shares[at] = m_body->contactShares[entry.contact->vertex];
    if (!entry.contact->touching) continue;
    lanes.sticks[at] = m_body->contact.stickStiffness;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lanes.anchors[(3 * entry.slot + axis) * m_width + entry.lane] = entry.contact->anchor[static_cast<int>(axis)];
    }
  }
}

template <class Real>
void PackPlanes<Real>::WriteBack() const {
  const PlaneLanes<Real> lanes = Lanes();
  for (const Entry& entry : m_entries) {
    Contact<Real>& contact = *entry.contact;
    contact.touching = lanes.sticks[entry.slot * m_width + entry.lane] > Real(0);
    contact.side = entry.plane->normal;
    if (!contact.touching) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      contact.anchor[static_cast<int>(axis)] = lanes.anchors[(3 * entry.slot + axis) * m_width + entry.lane];
    }
  }
}

template <class Real>
PlaneLanes<Real> PackPlanes<Real>::Lanes() const {
  const std::size_t count = m_slots.size() * m_width;
  Real* const numbers = reinterpret_cast<Real*>(m_numbers.data());
  return {.count = static_cast<std::uint32_t>(m_slots.size()),
          .width = static_cast<std::uint32_t>(m_width),
          .slots = m_slots.data(),
          .offsets = numbers,
          .shares = numbers + count,
          .sticks = numbers + 2 * count,
          .anchors = numbers + 3 * count};
}

template class PackPlanes<float>;
template class PackPlanes<double>;

}  // namespace wobble::physics
