// The experiment of the room: part of `wobble_lab contact`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys scene_intersecting_*, trial_intersecting_*: triangles of skins that intersect at the ends of ticks, in the
// shipped scenes and in random trials.
void MeasureIntersections(Bench& bench);

}  // namespace wobble::bench
