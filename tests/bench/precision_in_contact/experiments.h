// The experiments of the room: parts of `wobble_lab accuracy`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys order_rk4_in_contact, order_rk4_between_bodies: the order of RK4 where contacts press but neither begin nor end;
// order_rk4_bounce, order_rk4_slide, each also _without_friction: where they do.
void MeasureOrdersInContact(Bench& bench);
// No key: rows and a plot a scene of run time and error of each method in contact, with XPBD, vertex block descent and
// Bullet for comparison.
void MeasureWorkInContact(Bench& bench);

}  // namespace wobble::bench
