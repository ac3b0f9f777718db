// The principal shapes are the left singular vectors of the departures D, by falling singular value. They come from the
// eigenvectors of D Dᵀ or of Dᵀ D, whichever is smaller. That halves the digits of the small singular values, which a
// bound of a thousandth of the size never asks for, and takes a tenth of the time of a decomposition of D itself.
#include "server/export/modes.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace wobble::exporting {
namespace {

// All principal shapes, and the weights by which they make the departures.
void Decompose(const Eigen::MatrixXd& departures, Eigen::MatrixXd& shapes, Eigen::MatrixXd& weights) {
  using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;  // by rising eigenvalue
  if (departures.rows() <= departures.cols()) {
    shapes = Solver(departures * departures.transpose()).eigenvectors().rowwise().reverse();
    weights = shapes.transpose() * departures;
  } else {
    const Eigen::MatrixXd turned = Solver(departures.transpose() * departures).eigenvectors().rowwise().reverse();
    weights = turned.transpose();
    shapes = departures * turned;
  }
}

// Errors of so many vertices, of their squares in each frame.
double FindRms(const Eigen::VectorXd& squares, double vertices) {
  return std::sqrt(std::max(0.0, squares.mean()) / vertices);
}
double FindLargest(const Eigen::VectorXd& squares, double vertices) {
  return std::sqrt(std::max(0.0, squares.maxCoeff()) / vertices);
}

// Shapes or weights are orthonormal, so each takes its own part of the error away. A bound on the worst frame asks for
// a third more of them.
Eigen::Index CountNeeded(const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& weights, Eigen::VectorXd left,
                         double vertices, double bound) {
  Eigen::Index count = 0;
  while (count < weights.rows() && FindRms(left, vertices) > bound) {
    left -= shapes.col(count).squaredNorm() * weights.row(count).transpose().cwiseAbs2();
    ++count;
  }
  return count;
}

}  // namespace

Modes FindModes(const Eigen::Ref<const Eigen::MatrixXf>& departures, double bound) {
  const Eigen::MatrixXd wanted = departures.cast<double>();
  const double vertices = static_cast<double>(wanted.rows()) / 3;
  Modes modes{.shapes = Eigen::MatrixXf(wanted.rows(), 0), .weights = Eigen::MatrixXf(0, wanted.cols())};
  if (wanted.size() == 0) return modes;
  Eigen::VectorXd squares = wanted.colwise().squaredNorm().transpose();
  if (FindRms(squares, vertices) > bound) {
    Eigen::MatrixXd shapes, weights;
    Decompose(wanted, shapes, weights);
    // A little below the bound, for what rounding to single precision adds.
    const Eigen::Index count = CountNeeded(shapes, weights, squares, vertices, 0.999 * bound);
    const Eigen::VectorXd largest = weights.topRows(count).cwiseAbs().rowwise().maxCoeff();
    modes.shapes = (shapes.leftCols(count) * largest.asDiagonal()).cast<float>();
    modes.weights = (largest.cwiseInverse().asDiagonal() * weights.topRows(count)).cast<float>();
    const Eigen::MatrixXd error = wanted - modes.shapes.cast<double>() * modes.weights.cast<double>();
    squares = error.colwise().squaredNorm().transpose();
  }
  modes.error = FindRms(squares, vertices);
  modes.worstError = FindLargest(squares, vertices);
  return modes;
}

}  // namespace wobble::exporting
