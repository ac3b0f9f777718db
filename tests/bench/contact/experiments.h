// The experiments of `wobble_lab contact`, each with the share of the report's time that it takes.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key bounce_error: heights that bodies come back to.
void MeasureBounces(Bench& bench);
// No key: rows and a plot of the magnetic law and of backtracking beside the default.
void MeasureLaws(Bench& bench);
// Key slide_angle_error_deg: the slope on which a cube begins to slide.
void MeasureSlides(Bench& bench);
// Key momentum_drift: bodies that collide in free space.
void MeasureCollisions(Bench& bench);
// Keys stack_drift, stack_asleep_s, slab_stack_asleep_s and stack_changed_asleep: bodies on one another.
void MeasureStacks(Bench& bench);
// Key apart_growth: what a body costs the search for contacts, among many against among few.
void MeasureApart(Bench& bench);
// Key tunnelled: bodies shot at one another and at what stands still.
void MeasureShots(Bench& bench);

}  // namespace wobble::bench
