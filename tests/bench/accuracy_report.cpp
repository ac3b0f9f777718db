// `wobble_lab accuracy`: run time against error of every method, step and precision, compared with the same equations
// implemented a second time and solved by SUNDIALS, and with closed forms where they exist.
#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/precision_in_contact/experiments.h"

namespace wobble::bench {

void ReportAccuracy(Bench& bench) {
  constexpr Part kParts[] = {
      {"reference", 0.1, &MeasureReference},
      {"exact solutions", 0.05, &MeasureExactSolutions},
      {"orders", 0.05, &MeasureOrders},
      {"work and precision", 0.35, &MeasureWorkAndPrecision},
      {"energies", 0.02, &MeasureEnergies},
      {"opponents", 0.1, &MeasureOpponents},
      {"error targets", 0.15, &MeasureErrorTargets},
      {"error targets in contact", 0.05, &MeasureTouchingTargets},
      {"orders in contact", 0.01, &MeasureOrdersInContact},
      {"work and precision in contact", 0.25, &MeasureWorkInContact},
      {"scenes as played", 0.14, &MeasureScenes},
      {"laws", 0.01, &MeasureLaws},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
