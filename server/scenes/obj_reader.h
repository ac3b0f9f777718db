// Triangle meshes from Wavefront OBJ files: vertices and faces; all else that such files may hold is passed over.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/physics/shapes/mesh.h"

namespace wobble::scenes {

struct ObjMesh {
  std::vector<physics::Vector3d> vertices;  // as in the file
  std::vector<physics::Face> faces;         // polygons cut into fans; their vertices counted from 0
  // One a mistake, by line: "line 12: face 3 has vertex 9 of 8". Faces and vertices are counted from 1, as in the file.
  std::vector<std::string> errors;
};

[[nodiscard]] ObjMesh ParseObj(const std::string& text);

// A file that cannot be read is one error.
[[nodiscard]] ObjMesh LoadObj(const std::filesystem::path& path);

}  // namespace wobble::scenes
