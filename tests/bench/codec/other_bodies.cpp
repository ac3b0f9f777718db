// The same codec on what is no ball: a hung cloth of two patches, and solids.
#include "tests/bench/codec/curve.h"
#include "tests/bench/codec/experiments.h"

namespace wobble::bench {
namespace {

constexpr double kTarget = 0.0025;

void MeasureBody(Bench& bench, const std::string& name, const Recording& recording) {
  const RatePoint point = MeasurePoint(recording, MakeOurs(), kTarget);
  bench.results.rows.push_back({{"experiment", "other_bodies"},
                                {"body", name},
                                {"vertices", recording.CountVertices()},
                                {"speed_median", FindMedian(recording.speeds)},
                                {"deformation_median", 100 * FindMedian(recording.deformations)},
                                {"bits_per_vertex", point.bitsPerVertex},
                                {"error_percent", point.errorPercent},
                                {"error_percent_p999", point.errorPercentP999}});
  bench.results.AddFigure(name + "_bits_per_vertex_025", point.bitsPerVertex);
}

}  // namespace

void MeasureOtherBodies(Bench& bench) {
  const double seconds = bench.options.quick ? 5 : 30;
  const std::uint64_t seed = bench.options.seed;
  MeasureBody(bench, "cloth", RecordCloth(seed, seconds));
  MeasureBody(bench, "lattice", RecordLattices(Pattern::kChase, seed, seconds));
}

}  // namespace wobble::bench
