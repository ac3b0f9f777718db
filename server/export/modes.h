// The few shapes of which many are made.
#pragma once

#include <Eigen/Core>

namespace wobble::exporting {

// Column f of shapes × weights stands for column f of what was asked for.
struct Modes {
  Eigen::MatrixXf shapes;   // one a column
  Eigen::MatrixXf weights;  // one row a shape, one column a frame; the largest of a row has the amount 1
  // m, RMS over the vertices: in all frames, and in the one in which it is largest. As measured.
  double error = 0;
  double worstError = 0;
};

// As few principal shapes as keep the error, RMS over all vertices in all frames, at or below `bound`, m; none if
// nothing departs by more. departures: one column a frame, three rows a vertex, m, finite. Costs the eigenvectors of a
// matrix as large as there are rows or columns, whichever are fewer: 0.1 s for 500, 4 s for 2,000.
[[nodiscard]] Modes FindModes(const Eigen::Ref<const Eigen::MatrixXf>& departures, double bound);

}  // namespace wobble::exporting
