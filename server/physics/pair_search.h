// The tick's search for contacts between bodies: which bodies are near one another, by which vertices and faces, and
// which sleeping bodies wake because an awake one touches them.
#pragma once

#include <span>

#include "server/physics/world_engine.h"

namespace wobble::physics {

// The world's, as a tick finds it.
struct BodyTable {
  std::span<Body> bodies;
  std::span<const Blueprint> blueprints;
  Roster& roster;
};

// Fills in the workspace's PairLists from its boxes and members. A tick calls FindPairs, MeetAll, then WakeTouched and
// MeetAll again until nothing wakes, DropPairsApart, PullApart, and LetPairsRest at its end. The cost does not depend
// on sleeping bodies that no awake body is near.
template <class Real>
class PairSearch {
 public:
  // duration: of the tick, s. kernel: finds points near faces, side by side.
  PairSearch(const BodyTable& table, double duration, const SweepKernel<Real>& kernel, Threads& threads,
             Workspace<Real>& workspace)
      : m_table(table),
        m_duration(duration),
        m_kernel(kernel.points),
        m_threads(threads),
        m_work(workspace),
        m_lists(workspace.pairs) {}

  // Lists the pairs of an awake body and any other whose boxes overlap. Pairs that were near one another in the last
  // tick, or when they fell asleep, keep their contacts.
  void FindPairs();
  // Finds the contacts of all pairs that have not met in this tick: vertices of each body near faces of the other.
  // Contacts of two sleeping bodies stay as they are.
  void MeetAll();
  // Wakes sleeping bodies that have contacts with awake ones, and adds their pairs. They are then in PairLists::woken
  // and must be prepared before the next MeetAll. Returns false when nothing wakes.
  bool WakeTouched();
  // Drops pairs without contacts, whose boxes overlap but which form no island.
  void DropPairsApart();
  // Adds the forces that take skins out of one another to what pushes their bodies in this tick.
  void PullApart();
  // Puts the pairs of bodies that have just fallen asleep aside until one of their bodies wakes.
  void LetPairsRest();

 private:
  void AddOverlapsWithSleepers(std::uint32_t body);
  void AddOverlapWithSelf(std::uint32_t body);
  void AddPairs();
  void AttachSleeper(std::uint32_t body);
  void TakeRestingPairs();
  void ReserveSkins();
  void ReadSkins();
  [[nodiscard]] bool AreToMeet(const BodyPair<Real>& pair) const;
  void Meet(BodyPair<Real>& pair);
  void MeetFaces(std::size_t side, double fullGap, BodyPair<Real>& pair);
  void ForgetSides(BodyPair<Real>& pair);
  void MeetCores(BodyPair<Real>& pair);
  void MeetEdges(BodyPair<Real>& pair);
  void MeetSelf(BodyPair<Real>& pair);
  void LookForTangle(BodyPair<Real>& pair);
  [[nodiscard]] SelfSearch<Real> MakeSelfSearch(const Member<Real>& member) const;
  template <class Keep>
  void KeepPairs(const Keep& keep);
  void Separate(BodyPair<Real>& pair);
  [[nodiscard]] std::uint32_t FindPlace(BodyId id) const;
  void Recycle(BodyPair<Real>& pair);
  std::vector<BodyContact<Real>> TakeSpareList();

  [[nodiscard]] bool IsAsleep(std::uint32_t body) const { return m_table.bodies[body].asleep; }

  BodyTable m_table;
  double m_duration;
  PointKernel<Real> m_kernel;
  Threads& m_threads;
  Workspace<Real>& m_work;
  PairLists<Real>& m_lists;  // of the workspace
};

}  // namespace wobble::physics
