// Reads triangle meshes from Wavefront OBJ files: vertices and faces. Everything else in a file is ignored.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/physics/shapes/mesh.h"

namespace wobble::scenes {

struct ObjMesh {
  std::vector<physics::Vector3d> vertices;  // as in the file
  std::vector<physics::Face> faces;         // polygons are split into fans; vertices counted from 0
  // One per mistake, at most 20: "line 12: face 3 has vertex 9 of 8". Faces and vertices are counted from 1, as in the
  // file. Empty: the mesh can be used.
  std::vector<std::string> errors;
};

// Parses the text of a file. Never throws.
[[nodiscard]] ObjMesh ParseObj(const std::string& text);

// Reads a file into `text` and parses it. One that cannot be read, is empty, no regular file or larger than
// kMaxMeshBytes gives one error.
[[nodiscard]] ObjMesh LoadObj(const std::filesystem::path& path, std::string& text);

}  // namespace wobble::scenes
