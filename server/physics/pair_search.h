// The tick's search for contacts between bodies: who is near whom, with which vertices, and who is woken by that.
#pragma once

#include <span>

#include "server/physics/world_engine.h"

namespace wobble::physics {

// How near bodies are looked at beyond the way they go in the tick, m: what gravity and springs may add.
inline constexpr double kNearMargin = 0.02;

// Works on the workspace's `pairs`, from its boxes and members. Calls come in this order, once a tick; WakeTouched and
// MeetAll again until nobody wakes.
template <class Real>
class PairSearch {
 public:
  // duration: of the tick, s.
  PairSearch(std::span<Body> bodies, double duration, Threads& threads, Workspace<Real>& workspace)
      : m_bodies(bodies), m_duration(duration), m_threads(threads), m_work(workspace) {}

  // Whose boxes overlap. Those who were near one another in the last tick keep their contacts.
  void FindPairs();
  // Vertices near faces. Contacts of two that sleep stay as they are.
  void MeetAll();
  // Sleepers near somebody awake wake: they are then in `woken`, to be prepared before they meet others. False: nobody.
  bool WakeTouched();
  // Boxes that overlap without a vertex near a face bind nothing together.
  void DropPairsApart();

 private:
  void Meet(std::size_t pair);
  void Recycle(BodyPair<Real>& pair);
  std::vector<BodyContact<Real>> TakeSpareList();
  [[nodiscard]] bool HasNoFaces(std::uint32_t body) const;

  std::span<Body> m_bodies;
  double m_duration;
  Threads& m_threads;
  Workspace<Real>& m_work;
};

}  // namespace wobble::physics
