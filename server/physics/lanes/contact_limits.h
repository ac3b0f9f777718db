// What contacts between bodies are told apart by, for the plain code and the lanes alike.
#pragma once

namespace wobble::physics {

// A contact may begin this deep, m. It was found before the vertex came in, so a deeper beginning is none: each would
// bring in the energy of a spring that nobody pressed.
inline constexpr double kArmingDepth = 0.01;
// One that goes on may be deeper than it was by that and by the motion of so many substeps.
inline constexpr double kArmingSteps = 2;
// Sides flatter than this (cosine of the angle between normals, 45°) are those of a smooth surface: there a point
// changes its face where both planes are equally deep. Over a sharper edge it must truly leave the first face.
inline constexpr double kSmoothCosine = 0.7;
// A face can have been come in through when its normal and the vertex's own are farther apart than this (cosine, 107°).
// Where boxes meet flat it is 180° in the middle of a side, 135° on its edges and no less than 114° in its corners,
// whose normal is drawn to the side with more triangles; from the sides that a vertex only passes by, 90° or less,
// and a little more where the boxes yield.
inline constexpr double kFacingCosine = -0.3;

}  // namespace wobble::physics
