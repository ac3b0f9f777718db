// What recorded play says about a patch: how its coordinates vary together, and with what contact suggests.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::server {

// A moment of play.
struct PlayFrame {
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;  // in the world, m
};
struct RecordedPlay {
  std::vector<protocol::wire::Obstacle> obstacles;
  std::vector<PlayFrame> frames;
};

// Second moments of the departures from the rest shape, and of what contact suggests for them, in the body's frame:
// 3n × 3n, m².
struct BasisStatistics {
  Eigen::MatrixXd departure;
  Eigen::MatrixXd departureByContact;
  Eigen::MatrixXd contact;
};

// A turn or mirroring that maps a rest shape onto itself, and where each vertex goes.
struct Symmetry {
  Eigen::Matrix3d matrix;
  std::vector<std::size_t> image;
};
// At least the identity. Play favours none of them, so statistics are as good from a hundredth of the frames when they
// are averaged over all: on a ball that saves 0.15 bits a vertex.
[[nodiscard]] std::vector<Symmetry> FindSymmetries(std::span<const protocol::Vector3> rest);

// rest: of the patch that begins at vertex `first` of the frames' bodies; there is a frame at least.
[[nodiscard]] BasisStatistics MeasurePlay(const RecordedPlay& play, std::span<const protocol::Vector3> rest,
                                          std::size_t first);

}  // namespace wobble::server
