#include "server/physics/pack_contacts.h"

namespace wobble::physics {

template <class Real>
void PackContacts<Real>::Reserve(std::size_t contacts) {
  m_entries.reserve(contacts);
  m_numbers.reserve((contacts * sizeof(Real) / sizeof(Line) + 1) * kNumbers);
}

template <class Real>
void PackContacts<Real>::Clear(const Coefficients<Real>& body) {
  m_body = &body;
  m_entries.clear();
}

template <class Real>
void PackContacts<Real>::Close() {
  constexpr std::size_t kInLine = 64 / sizeof(Real);
  const std::size_t lines = (m_entries.size() + kInLine - 1) / kInLine;
  m_capacity = lines * kInLine;
  m_numbers.assign(lines * kNumbers, {});
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const Entry& entry = m_entries[i];
    Row(kFriction)[i] = m_body->contact.friction * entry.surface->friction;
    Row(kShare)[i] = m_body->contactShares[entry.contact->vertex];
    ReadAnchor(i);
  }
}

template <class Real>
void PackContacts<Real>::ReadAnchor(std::size_t i) {
  const Contact<Real>& contact = *m_entries[i].contact;
  Row(kStick)[i] = contact.touching ? m_body->contact.stickStiffness : Real(0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Row(kAnchor + axis)[i] = contact.touching ? contact.anchor[static_cast<int>(axis)] : Real(0);
  }
}

template <class Real>
void PackContacts<Real>::ReadPoints(const Real* state, std::size_t width) {
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const Entry& entry = m_entries[i];
    const Real* numbers = state + 6 * entry.seat.place * width + entry.seat.lane;
    const Vector3<Real> x(numbers[0], numbers[width], numbers[2 * width]);
    const SurfacePoint<Real> point = FindContactPoint(*entry.surface, *entry.contact, x);
    Row(kDistance)[i] = point.distance;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Row(kX + axis)[i] = x[static_cast<int>(axis)];
      Row(kV + axis)[i] = numbers[(3 + axis) * width];
      Row(kNormal + axis)[i] = point.normal[static_cast<int>(axis)];
    }
  }
}

template <class Real>
void PackContacts<Real>::ComputeForces(ContactKernel<Real> kernel) {
  const ContactParameters<Real>& parameters = m_body->contact;
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
  kernel({parameters.stiffness, parameters.fadeDepth, parameters.damping, parameters.stickDamping}, lanes);
}

template <class Real>
void PackContacts<Real>::Update(const Real* state, std::size_t width) {
  for (std::size_t i = 0; i < m_entries.size(); ++i) {
    const Entry& entry = m_entries[i];
    const Real* numbers = state + 6 * entry.seat.place * width + entry.seat.lane;
    UpdateAnchor(m_body->contact, *entry.surface, Vector3<Real>(numbers[0], numbers[width], numbers[2 * width]),
                 *entry.contact);
    ReadAnchor(i);
  }
}

template class PackContacts<float>;
template class PackContacts<double>;

}  // namespace wobble::physics
