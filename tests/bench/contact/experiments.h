// The experiments of `wobble_lab contact`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key bounce_error: the height to which bodies bounce back.
void MeasureBounces(Bench& bench);
// No key: rows and a plot of the magnetic contact law and of backtracking, with the default law for comparison.
void MeasureLaws(Bench& bench);
// Key slide_angle_error_deg: the slope at which a cube begins to slide.
void MeasureSlides(Bench& bench);
// Key momentum_drift: momentum of bodies that collide in free space.
void MeasureCollisions(Bench& bench);
// Keys stack_drift, stack_asleep_s, slab_stack_asleep_s, stack_changed_asleep: stacks of bodies.
void MeasureStacks(Bench& bench);
// Key apart_growth: cost per body of the search for contact pairs, among many bodies over among few.
void MeasureApart(Bench& bench);
// Keys error_target_met_in_contact*, error_over_estimate_in_contact*: bodies that touch, stepped as the server steps
// them. Part of `wobble_lab accuracy`.
void MeasureTouchingTargets(Bench& bench);
// Key tunnelled: bodies shot at each other and at fixed targets.
void MeasureShots(Bench& bench);

}  // namespace wobble::bench
