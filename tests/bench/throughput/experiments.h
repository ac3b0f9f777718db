// The experiments of `wobble_lab throughput`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys ns_per_vertex_step, plain_ns_per_vertex_step, speedup_vs_plain, peak_share, lone_ratio: the cost of a step.
void MeasureVertexSteps(Bench& bench);
// Keys vertex_ticks_per_s, thread_scaling_2: the cost of a whole tick of balls apart.
void MeasureTicks(Bench& bench);
// Key speedup_vs_bullet: balls apart, against Bullet.
void MeasureBulletApart(Bench& bench);
// Keys touching_ms_per_tick, speedup_vs_bullet_touching: balls pressed together, against Bullet.
void MeasureBulletTouching(Bench& bench);
// Keys ladder_lanes_filled, ladder_cost: the cost of packs that are not full.
void MeasureLadder(Bench& bench);
// Keys *_exponent: lattices against gas over size.
void MeasureSizes(Bench& bench);
// No key: rows and a plot of the whole tick over the number of bodies, apart and pressed together.
void MeasureCrowds(Bench& bench);

}  // namespace wobble::bench
