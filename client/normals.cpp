#include "client/normals.h"

#include <algorithm>

namespace wobble::client {

void SumFaceNormals(std::span<const protocol::Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                    std::span<protocol::Vector3> normals) {
  std::fill(normals.begin(), normals.end(), protocol::Vector3{});
  for (const auto& [a, b, c] : faces) {
    const protocol::Vector3 twiceArea = Cross(vertices[b] - vertices[a], vertices[c] - vertices[a]);
    for (const std::uint16_t corner : {a, b, c}) normals[corner] = normals[corner] + twiceArea;
  }
}

void FindNormals(std::span<const protocol::Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                 std::span<protocol::Vector3> normals) {
  SumFaceNormals(vertices, faces, normals);
  for (protocol::Vector3& normal : normals) {
    const float length = Length(normal);
    normal = length > 0 ? normal * (1 / length) : protocol::Vector3{};
  }
}

}  // namespace wobble::client
