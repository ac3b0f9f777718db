// A corner of a face is v, v/vt, v//vn or v/vt/vn, where v counts from 1, or backwards from the last vertex so far if
// it is negative.
#include "server/scenes/obj_reader.h"

#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "server/scenes/table_reader.h"
#include "server/scenes/text_file.h"

namespace wobble::scenes {
namespace {

constexpr std::size_t kMaxMistakes = 20;  // listed of one file

class ObjParser {
 public:
  ObjMesh Parse(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      ++m_line;
      std::istringstream words(line.substr(0, line.find('#')));
      std::string keyword;
      words >> keyword;
      if (keyword == "v") ReadVertex(words);
      if (keyword == "f") ReadFace(words);
    }
    FindFaults();
    return std::move(m_mesh);
  }

 private:
  struct Origin {
    int line;
    int face;
  };

  void Refuse(int line, const std::string& what) {
    if (m_mesh.errors.size() < kMaxMistakes) m_mesh.errors.push_back("line " + std::to_string(line) + ": " + what);
  }

  void ReadVertex(std::istringstream& words) {
    ++m_vertexCount;
    physics::Vector3d vertex = physics::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      std::string word;
      words >> word;
      double& value = vertex[axis];
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (word.empty() || error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
        return Refuse(m_line, "vertex " + std::to_string(m_vertexCount) + " has '" + Abbreviate(word) +
                                  "' where a number belongs");
      }
    }
    if (m_mesh.vertices.size() == physics::kMaxMeshVertices) {
      Refuse(m_line, "vertex " + std::to_string(m_vertexCount) + ": at most " +
                         std::to_string(physics::kMaxMeshVertices) + " vertices");
    }
    if (m_mesh.vertices.size() <= physics::kMaxMeshVertices) m_mesh.vertices.push_back(vertex);
  }

  void ReadFace(std::istringstream& words) {
    ++m_faceCount;
    const std::string name = "face " + std::to_string(m_faceCount);
    std::vector<std::uint16_t> corners;
    std::string word;
    while (words >> word) {
      int index = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
      if (error != std::errc() || (end != word.data() + word.size() && *end != '/')) {
        return Refuse(m_line, name + " has '" + Abbreviate(word) + "' where a vertex belongs");
      }
      if (index < 0) index += m_vertexCount + 1;
      if (index < 1 || index > m_vertexCount) {
        return Refuse(m_line, name + " has vertex '" + Abbreviate(word) + "' of " + std::to_string(m_vertexCount));
      }
      corners.push_back(static_cast<std::uint16_t>(std::min<int>(index - 1, physics::kMaxMeshVertices)));
    }
    if (corners.size() < 3) return Refuse(m_line, name + " has " + std::to_string(corners.size()) + " corners");
    for (std::size_t i = 2; i < corners.size(); ++i) {
      if (m_mesh.faces.size() >= 2 * physics::kMaxMeshVertices + 2)
        return;  // the file has too many vertices as well: reported already
      m_mesh.faces.push_back({corners[0], corners[i - 1], corners[i]});
      m_origins.push_back({m_line, m_faceCount});
    }
  }

  // Checks the mesh for geometric faults, once the file has no other mistakes.
  void FindFaults() {
    if (!m_mesh.errors.empty()) return;
    int last = 0;
    for (const physics::MeshFault& fault : physics::FindMeshFaults(m_mesh.vertices, m_mesh.faces)) {
      const Origin& origin = m_origins[fault.face];
      if (origin.face != last) Refuse(origin.line, "face " + std::to_string(origin.face) + " " + fault.what);
      last = origin.face;
    }
  }

  ObjMesh m_mesh;
  std::vector<Origin> m_origins;  // of each triangle
  int m_line = 0;
  int m_vertexCount = 0;
  int m_faceCount = 0;
};

}  // namespace

ObjMesh ParseObj(const std::string& text) { return ObjParser().Parse(text); }

ObjMesh LoadObj(const std::filesystem::path& path, std::string& text) {
  ObjMesh mesh;
  std::string fault = ReadTextFile(path, kMaxMeshBytes, text);
  if (fault.empty() && text.empty()) fault = "is empty";
  if (fault.empty()) return ParseObj(text);
  mesh.errors.push_back(std::move(fault));
  return mesh;
}

}  // namespace wobble::scenes
