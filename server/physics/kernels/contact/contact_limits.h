// Thresholds of contacts between bodies that the plain code and the kernels share.
#pragma once

namespace wobble::physics {

// A contact may begin at most this deep, m. Contacts are found before their vertices come in; a deeper beginning would
// bring in the energy of a spring that nobody pressed.
inline constexpr double kArmingDepth = 0.01;
// A contact that goes on may grow deeper in a substep by kArmingDepth and by the motion of this many substeps.
inline constexpr double kArmingSteps = 2;
// Two faces are those of a smooth skin if the cosine between their normals is above this (45°): there a point changes
// its face where both planes are equally deep. Over a sharper edge it must truly leave the first face.
inline constexpr double kSmoothCosine = 0.7;
// A vertex can have come in through a face if the angle between the face's normal and the vertex's own is larger than
// this (cosine, 107°). Where boxes meet flat, that angle is 180° in the middle of a side, 135° on its edges and no less
// than 114° in its corners, whose normal is drawn to the side with more triangles. With the sides that a vertex only
// passes by it is 90° or less, and a little more where the boxes yield.
inline constexpr double kFacingCosine = -0.3;

}  // namespace wobble::physics
