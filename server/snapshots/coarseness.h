// How coarsely the bodies of one client's snapshots are encoded, so that its budget leaves out as few as it can.
#pragma once

#include <cstddef>

namespace wobble::server {

// What near bodies may take of the budget before the others: what is left gives those a few samples a second.
inline constexpr double kNearShare = 0.8;

// The qualities (encoder.h) that one client gets, adapted to its budget.
class Coarseness {
 public:
  // What the snapshots of one turn, in which each body was due once, have cost.
  struct Turn {
    double credit = 0;         // bytes by which the budget has grown
    double near = 0;           // bytes of near bodies
    double far = 0;            // of others, and of packets' heads
    std::size_t due = 0;       // bodies
    std::size_t leftOut = 0;   // of these
    std::size_t nearLeft = 0;  // near ones that kNearShare did not hold
  };
  void Adapt(const Turn& turn);
  // Whether a larger budget would make any quality finer.
  [[nodiscard]] bool IsCoarse() const { return m_near.value > 0 || m_far.value > 0; }

  // The quality of a body at this apparent distance, m. isNear: within FindNearRadius, or the own body.
  [[nodiscard]] std::size_t FindQuality(bool isNear, float apparentDistance) const;

 private:
  // One of two levels, raised when the budget has been too small for a while and lowered when it has been large enough
  // for the next finer quality.
  struct Level {
    std::size_t value = 0;
    int crowded = 0;  // turns in a row
    int easy = 0;
    void Note(bool isCrowded, bool isEasy, std::size_t most);
  };
  Level m_near;
  Level m_far;
};

// While the machine is short of time: a body is encoded at no more than three of the qualities, and at two where
// budgets suffice. distance: m; 0 for the own body.
[[nodiscard]] std::size_t FindCoarserQuality(std::size_t quality, float distance);

}  // namespace wobble::server
