// How a record's step and worth of a bit are searched: the decisions alone, which one body and a crowd share.
#pragma once

#include "protocol/codec/shape_layout.h"

namespace wobble::protocol {

// Squared steps of error that a bit is worth.
inline constexpr float kBitWorth = 0.1F;

struct Choice {
  ShapeHead head;
  float bitWorth = kBitWorth;

  [[nodiscard]] int StepLevel() const { return FindStepLevel(head.pose.grid.grid, head.stepIndex); }
};

// The search of one record: rounds its coefficients as `choice` says, until Judge is content.
//
// It looks for the coarsest step at which the error stays within the budget, and then for the highest worth of a bit,
// in three or four tries.
class StepSearch {
 public:
  enum class Verdict {
    kAgain,  // round again, as `choice` now says
    kTaken,  // this try stands
    kBest,   // the try stands that was kept last; `choice` is its own again
  };

  // budget: the squared error allowed, m². The search begins at the choice's step.
  StepSearch(double budget, Choice& choice) : m_budget(budget) { choice.bitWorth = kBitWorth; }
  // error: of the coefficients rounded as `choice` said, m². Keeps: the coefficients must be kept as the best so far.
  [[nodiscard]] Verdict Judge(double error, Choice& choice);
  [[nodiscard]] bool Keeps() const { return m_keeps; }
  // After kTaken and kBest: the error that is left to make zeros of ones, m²; 0: nothing.
  [[nodiscard]] double Left() const { return m_left; }

 private:
  // Chooses what to try next; false when there is nothing.
  [[nodiscard]] bool FindNext(double error, Choice& choice) const;

  double m_budget;
  double m_bestError = -1;
  double m_left = 0;
  Choice m_best;
  int m_tries = 0;
  bool m_descends = false;  // to finer steps until one is within the budget
  bool m_keeps = false;
};

}  // namespace wobble::protocol
