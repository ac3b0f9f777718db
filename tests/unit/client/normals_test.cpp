#include "client/normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace wobble::client {
namespace {

using protocol::Vector3;

TEST(Normals, AreWeightedByArea) {
  // A large face with its normal along z and a small one with its normal along x share an edge.
  const std::vector<Vector3> vertices{{0, 0, 0}, {0, 1, 0}, {-10, 0, 0}, {0, 0, -1}, {9, 9, 9}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 3, 1}};
  std::vector<Vector3> normals(vertices.size(), {7, 7, 7});
  FindNormals(vertices, faces, normals);
  EXPECT_NEAR(normals[2].z, 1, 1e-6);
  EXPECT_NEAR(std::abs(normals[3].x), 1, 1e-6);
  EXPECT_NEAR(normals[0].z / std::abs(normals[0].x), 10, 1e-5);
  EXPECT_NEAR(Length(normals[0]), 1, 1e-6);
  EXPECT_EQ(Length(normals[4]), 0);  // of no face
}

}  // namespace
}  // namespace wobble::client
