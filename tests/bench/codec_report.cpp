// `wobble_lab codec`: bits on the wire for the shapes of bodies against their error, with other codecs on the same
// frames in the same run.
#include "tests/bench/codec/experiments.h"

namespace wobble::bench {

void ReportCodec(Bench& bench) {
  constexpr Part kParts[] = {
      {"curves", 0.85, &MeasureCurves},
      {"other bodies", 0.05, &MeasureOtherBodies},
      {"rest", 0.03, &MeasureRest},
      {"times", 0.07, &MeasureCodecTimes},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
