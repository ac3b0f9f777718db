// Vertex normals, for drawing.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocol/geometry.h"

namespace wobble::client {

// The sum of the normals of the faces around each vertex, each as long as twice the face's area, m². Faces name
// existing vertices. normals: one a vertex, overwritten.
void SumFaceNormals(std::span<const protocol::Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                    std::span<protocol::Vector3> normals);

// The same, normalised; zero where there is no area.
// normals: one a vertex, overwritten.
void FindNormals(std::span<const protocol::Vector3> vertices, std::span<const std::array<std::uint16_t, 3>> faces,
                 std::span<protocol::Vector3> normals);

}  // namespace wobble::client
