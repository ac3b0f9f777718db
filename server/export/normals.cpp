// The derivative of the normals by each mode at rest would be simpler, and wrong for a cloth that folds: it departs
// from rest by more than its size.
#include "server/export/normals.h"

#include "server/physics/model/vector.h"

namespace wobble::exporting {

std::vector<float> FindNormals(std::span<const float> positions, std::span<const physics::Face> faces) {
  std::vector<float> normals(positions.size(), 0);
  const auto at = [&](std::size_t vertex) {
    return Eigen::Map<const physics::Vector3f>(positions.data() + 3 * vertex);
  };
  for (const physics::Face& face : faces) {
    const physics::Vector3f area = (at(face[1]) - at(face[0])).cross(at(face[2]) - at(face[0]));
    for (const std::size_t vertex : face) Eigen::Map<physics::Vector3f>(normals.data() + 3 * vertex) += area;
  }
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    Eigen::Map<physics::Vector3f> normal(normals.data() + i);
    const float length = normal.stableNorm();
    normal = length > 0 ? physics::Vector3f(normal / length) : physics::Vector3f::UnitZ();
  }
  return normals;
}

std::vector<std::vector<float>> FindNormalModes(const Eigen::Ref<const Eigen::MatrixXf>& departures, const Modes& modes,
                                                std::span<const float> rest, std::span<const float> normals,
                                                std::span<const physics::Face> faces) {
  const auto size = static_cast<Eigen::Index>(rest.size());
  const Eigen::Map<const Eigen::VectorXf> restShape(rest.data(), size), atRest(normals.data(), size);
  Eigen::MatrixXf found = Eigen::MatrixXf::Zero(size, modes.weights.rows());
  std::vector<float> positions(rest.size());
  for (Eigen::Index frame = 0; frame < departures.cols(); ++frame) {
    Eigen::Map<Eigen::VectorXf>(positions.data(), size) = restShape + departures.col(frame);
    const std::vector<float> present = FindNormals(positions, faces);
    const Eigen::VectorXf change = Eigen::Map<const Eigen::VectorXf>(present.data(), size) - atRest;
    found.noalias() += change * modes.weights.col(frame).transpose();
  }
  // The modes' weights are orthogonal, so each mode is fitted by itself.
  std::vector<std::vector<float>> changes;
  for (Eigen::Index mode = 0; mode < found.cols(); ++mode) {
    found.col(mode) /= modes.weights.row(mode).squaredNorm();
    changes.emplace_back(found.col(mode).begin(), found.col(mode).end());
  }
  return changes;
}

}  // namespace wobble::exporting
