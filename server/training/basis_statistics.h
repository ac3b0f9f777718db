// Statistics of recorded play: how a patch's coordinates vary together, and how they vary with what contact predicts.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::server {

// One body at one tick.
struct PlayFrame {
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;  // in the world's frame, m
};
struct RecordedPlay {
  std::vector<protocol::wire::Obstacle> obstacles;
  std::vector<PlayFrame> frames;
};

// Second moments in the body's frame, 3n × 3n for a patch of n vertices, m².
struct BasisStatistics {
  Eigen::MatrixXd departure;           // of the departures from the rest shape
  Eigen::MatrixXd departureByContact;  // of these with the departures that contact predicts
  Eigen::MatrixXd contact;             // of the predicted departures
};

// A rotation or reflection that maps a rest shape onto itself.
struct Symmetry {
  Eigen::Matrix3d matrix;
  std::vector<std::size_t> image;  // the vertex onto which each vertex is mapped
};
// Finds the symmetries of a rest shape; the identity is always among them. Play favours none of them, so statistics
// that are averaged over all symmetries are as good from a hundredth of the frames: on a ball that saves 0.15 bits per
// vertex.
[[nodiscard]] std::vector<Symmetry> FindSymmetries(std::span<const protocol::Vector3> rest);

// Measures the patch that begins at vertex `first` of the recorded bodies. rest: its vertices, m. The play has at least
// one frame.
[[nodiscard]] BasisStatistics MeasurePlay(const RecordedPlay& play, std::span<const protocol::Vector3> rest,
                                          std::size_t first);

}  // namespace wobble::server
