// The search turns a quaternion until Σ r_col × a_col vanishes (Müller, Bender, Chentanez & Macklin 2016).
//
// A singular value decomposition was rejected: it jumps when a flattened body makes A degenerate, and whoever
// interpolates would show the jump as a flip.
#include "server/physics/model/rotation.h"

#include <cmath>

namespace wobble::physics {

Eigen::Quaterniond FindRotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& near) {
  Eigen::Quaterniond q = near;
  for (int round = 0; round < 20; ++round) {
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const Vector3d turn = r.col(0).cross(a.col(0)) + r.col(1).cross(a.col(1)) + r.col(2).cross(a.col(2));
    const double along = r.col(0).dot(a.col(0)) + r.col(1).dot(a.col(1)) + r.col(2).dot(a.col(2));
    const Vector3d omega = turn / (std::fabs(along) + 1e-9);
    const double angle = omega.norm();
    if (angle < 1e-6) break;
    q = Eigen::Quaterniond(Eigen::AngleAxisd(angle, omega / angle)) * q;
    q.normalize();
  }
  return q;
}

}  // namespace wobble::physics
