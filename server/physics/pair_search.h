// The tick's search for contacts between bodies: who is near whom, with which vertices, and who is woken by that.
#pragma once

#include <span>

#include "server/physics/world_engine.h"

namespace wobble::physics {

// How near bodies are looked at beyond the way they go in the tick, m: what gravity and springs may add.
inline constexpr double kNearMargin = 0.02;

// The world's, as a tick finds it.
struct BodyTable {
  std::span<Body> bodies;
  std::span<const Blueprint> blueprints;
  Roster& roster;
};

// Works on the workspace's `pairs`, from its boxes and members. Calls come in this order, once a tick; WakeTouched and
// MeetAll again until nobody wakes. Nothing here looks at a sleeper that nobody awake is near.
template <class Real>
class PairSearch {
 public:
  // duration: of the tick, s.
  PairSearch(const BodyTable& table, double duration, Threads& threads, Workspace<Real>& workspace)
      : m_table(table), m_duration(duration), m_threads(threads), m_work(workspace) {}

  // Of those awake, whose boxes overlap one another's or a sleeper's. Those who were near one another in the last tick,
  // or when they fell asleep, keep their contacts.
  void FindPairs();
  // Vertices near faces. Contacts of two that sleep stay as they are.
  void MeetAll();
  // Sleepers near somebody awake wake: they are then in `woken`, to be prepared before they meet others. False: nobody.
  bool WakeTouched();
  // Boxes that overlap without a vertex near a face bind nothing together.
  void DropPairsApart();
  // After the tick: pairs of those who have just fallen asleep are put aside until somebody wakes them.
  void LetPairsRest();

 private:
  void AddOverlapsWithSleepers(std::uint32_t body);
  void AddPairs();
  void AttachSleeper(std::uint32_t body);
  void TakeRestingPairs();
  void Meet(BodyPair<Real>& pair);
  template <class Keep>
  void KeepPairs(const Keep& keep);
  void Recycle(BodyPair<Real>& pair);
  std::vector<BodyContact<Real>> TakeSpareList();

  [[nodiscard]] bool IsAsleep(std::uint32_t body) const { return m_table.bodies[body].asleep; }
  [[nodiscard]] bool HasNoFaces(std::uint32_t body) const {
    return m_table.blueprints[m_table.bodies[body].blueprint].full.faces.empty();
  }

  BodyTable m_table;
  double m_duration;
  Threads& m_threads;
  Workspace<Real>& m_work;
};

}  // namespace wobble::physics
