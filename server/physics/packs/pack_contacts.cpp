// Distances and normals come from plain code, one contact after the other, since surfaces differ; the kernel computes
// the forces. After a substep Update reads the points of the new state, and the first stage of the next substep, which
// is at the same state, reuses them.
#include "server/physics/packs/pack_contacts.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {

template <class Real>
void PackContacts<Real>::Reserve(std::size_t contacts) {
  m_entries.reserve(contacts);
  m_numbers.reserve((contacts * sizeof(Real) / sizeof(Line) + 1) * kNumbers);
}

template <class Real>
void PackContacts<Real>::Clear(const Coefficients<Real>& body, std::size_t width) {
  m_body = &body;
  m_width = width;
  m_entries.clear();
  m_isRead = false;
}

template <class Real>
void PackContacts<Real>::Close() {
  constexpr std::size_t kInLine = 64 / sizeof(Real);
  const std::size_t lines = (m_entries.size() + kInLine - 1) / kInLine;
  m_capacity = lines * kInLine;
  m_numbers.assign(lines * kNumbers, {});
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const Entry& entry = m_entries[i];
    const Contact<Real>& contact = *entry.contact;
    Row(kFriction)[i] = m_body->contact.friction * entry.surface->friction;
    Row(kShare)[i] = m_body->contactShares[contact.vertex];
    Row(kStick)[i] = contact.touching ? m_body->contact.stickStiffness : Real(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Row(kAnchor + axis)[i] = contact.touching ? contact.anchor[static_cast<int>(axis)] : Real(0);
    }
  }
}

template <class Real>
void PackContacts<Real>::ReadPoints(const Real* state) {
  Real* const rows[6] = {Row(kX), Row(kX + 1), Row(kX + 2), Row(kV), Row(kV + 1), Row(kV + 2)};
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const Real* numbers = state + 6 * m_entries[i].seat.place * m_width + m_entries[i].seat.lane;
    for (std::size_t k = 0; k < 6; ++k) rows[k][i] = numbers[k * m_width];
  }
  Real* const distances = Row(kDistance);
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const SurfacePoint<Real> point = FindContactPoint(*m_entries[i].surface, *m_entries[i].contact,
                                                      Vector3<Real>(rows[0][i], rows[1][i], rows[2][i]));
    distances[i] = point.distance;
    for (std::size_t axis = 0; axis < 3; ++axis) Row(kNormal + axis)[i] = point.normal[static_cast<int>(axis)];
  }
}

template <class Real>
void PackContacts<Real>::ComputeForces(ContactKernel<Real> kernel) {
  ContactLanes<Real> lanes;
  lanes.count = m_entries.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lanes.x[axis] = Row(kX + axis);
    lanes.v[axis] = Row(kV + axis);
    lanes.normal[axis] = Row(kNormal + axis);
    lanes.anchor[axis] = Row(kAnchor + axis);
    lanes.force[axis] = Row(kForce + axis);
  }
  lanes.distance = Row(kDistance);
  lanes.stick = Row(kStick);
  lanes.friction = Row(kFriction);
  lanes.share = Row(kShare);
  kernel(ReadLaw(m_body->contact), lanes);
}

template <class Real>
void PackContacts<Real>::Update(const Real* state, Real h) {
  ReadPoints(state);
  m_isRead = true;
  const ContactParameters<Real>& law = m_body->contact;
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const bool wasTouching = Row(kStick)[i] != Real(0);
    const bool touches = Row(kDistance)[i] < Real(0);
    const Vector3<Real> normal(Row(kNormal)[i], Row(kNormal + 1)[i], Row(kNormal + 2)[i]);
    m_entries[i].contact->side = normal;
    Row(kStick)[i] = touches ? law.stickStiffness : Real(0);
    if (!touches) continue;
    const Real depth = -Row(kDistance)[i];
    const Vector3<Real> x(Row(kX)[i], Row(kX + 1)[i], Row(kX + 2)[i]);
    Vector3<Real> anchor(Row(kAnchor)[i], Row(kAnchor + 1)[i], Row(kAnchor + 2)[i]);
    if (!wasTouching) {
      anchor = x - FindFirstSlip<Real>(h, depth, normal, {Row(kV)[i], Row(kV + 1)[i], Row(kV + 2)[i]});
    }
    anchor = DragAnchor<Real>(law, Row(kFriction)[i], depth, normal, x, anchor);
    for (std::size_t axis = 0; axis < 3; ++axis) Row(kAnchor + axis)[i] = anchor[static_cast<int>(axis)];
  }
}

template <class Real>
void PackContacts<Real>::WriteBack() const {
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    Contact<Real>& contact = *m_entries[i].contact;
    contact.touching = Row(kStick)[i] != Real(0);
    if (contact.touching) contact.anchor = {Row(kAnchor)[i], Row(kAnchor + 1)[i], Row(kAnchor + 2)[i]};
  }
}

template class PackContacts<float>;
template class PackContacts<double>;

}  // namespace wobble::physics
