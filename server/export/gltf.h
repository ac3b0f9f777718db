// An animation in binary glTF 2.0, for Blender and the web.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "server/export/clip.h"

namespace wobble::exporting {

struct GltfLimits {
  // RMS over the vertices that are seen in all frames, as a share of the body's size.
  double error = 0.005;
  std::uint64_t shapeBytes = std::uint64_t{512} << 20;  // of all bodies in all frames, while the frames are read
};

// Lengths in m, times in s since the first frame. A root node turns the scene's axes, z up, into glTF's, y up. Below it
// each body is a node with its pose (mean of the vertices, and the rotation nearest to rest) and a mesh: the rest
// shape, with the fewest principal shapes as morph targets that keep the error at the frames within the limit.
// `extras` of the asset and of each node tell the errors that were reached. Bodies that come and go have scale 0 while
// they are not there. A body that tears has a child node for each state of its faces or springs, of which one has not
// scale 0; a body whose vertices change has a node for each set of them. Faces are triangles with normals, seen from
// both sides if the surface is open; bodies without faces are lines and points.
class GltfWriter : public FrameWriter {
 public:
  // scene: its name, for people.
  GltfWriter(std::filesystem::path file, std::string scene, const GltfLimits& limits = {});

  [[nodiscard]] std::string Add(const Frame& frame) override;
  [[nodiscard]] std::string Finish() override;

 private:
  std::filesystem::path m_file;
  std::string m_scene;
  GltfLimits m_limits;
  Clip m_clip;
};

}  // namespace wobble::exporting
