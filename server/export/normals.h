// Normals of meshes that change their shape.
#pragma once

#include <span>
#include <vector>

#include "server/export/modes.h"
#include "server/physics/model/topology.h"

namespace wobble::exporting {

// Three numbers a vertex in all of these. Of length 1, each the mean over the faces round the vertex, by their areas;
// of a vertex without faces up.
[[nodiscard]] std::vector<float> FindNormals(std::span<const float> positions, std::span<const physics::Face> faces);

// For each mode the change of the normals that, times the mode's weights, comes nearest to the normals in all frames
// (least squares). departures: as for FindModes. normals: of the rest shape.
[[nodiscard]] std::vector<std::vector<float>> FindNormalModes(const Eigen::Ref<const Eigen::MatrixXf>& departures,
                                                              const Modes& modes, std::span<const float> rest,
                                                              std::span<const float> normals,
                                                              std::span<const physics::Face> faces);

}  // namespace wobble::exporting
