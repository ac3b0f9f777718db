// A file of binary glTF 2.0: a document in JSON, and the numbers that it names.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace wobble::exporting {

class Glb {
 public:
  using Json = nlohmann::ordered_json;

  // All but buffers, their views and accessors, which Write adds. Empty arrays are left out, as glTF wants it.
  Json document;

  // These return the number of the new accessor.
  // Three numbers a vertex. Of positions glTF asks for the least and the largest.
  [[nodiscard]] std::size_t AddPositions(std::span<const float> values);
  [[nodiscard]] std::size_t AddNormals(std::span<const float> values);
  [[nodiscard]] std::size_t AddIndices(std::span<const std::uint16_t> values);
  // s, rising. The same times again are the same accessor.
  [[nodiscard]] std::size_t AddTimes(const std::vector<float>& times);
  // type: SCALAR, VEC3 or VEC4.
  [[nodiscard]] std::size_t AddKeys(std::span<const float> values, const char* type);

  // Returns what is wrong, in words that follow the name of the file; empty: nothing. Called once, at last.
  [[nodiscard]] std::string Write(const std::filesystem::path& file);

 private:
  // The views of the buffer, in its order.
  enum View : std::size_t { kVertices, kKeys, kIndices, kViewCount };

  std::size_t AddAccessor(View view, const void* values, std::size_t bytes, Json accessor);
  // Adds the views that are not empty. Returns the bytes of the buffer.
  std::size_t DescribeBuffer();

  std::array<std::string, kViewCount> m_bytes;
  Json m_accessors = Json::array();
  std::map<std::vector<float>, std::size_t> m_times;
};

}  // namespace wobble::exporting
