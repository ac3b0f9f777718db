// One view of the buffer for each use of its numbers, not one an accessor, keeps the document short.
#include "server/export/glb.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <fstream>
#include <limits>

#include "server/export/output.h"

namespace wobble::exporting {
namespace {

static_assert(std::endian::native == std::endian::little);

// The numbers of glTF.
constexpr int kFloat = 5126;
constexpr int kUnsignedShort = 5123;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

std::size_t RoundUpToFour(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

void WriteNumber(std::ofstream& out, std::size_t number) {
  const auto word = static_cast<std::uint32_t>(number);
  out.write(reinterpret_cast<const char*>(&word), sizeof word);
}

// The least and the largest of each of three components.
void AddRange(std::span<const float> values, nlohmann::ordered_json& accessor) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float least = values[axis], largest = values[axis];
    for (std::size_t i = axis; i < values.size(); i += 3) {
      least = std::min(least, values[i]);
      largest = std::max(largest, values[i]);
    }
    accessor["min"].push_back(least);
    accessor["max"].push_back(largest);
  }
}

}  // namespace

std::size_t Glb::AddAccessor(View view, const void* values, std::size_t bytes, Json accessor) {
  accessor["bufferView"] = view;
  accessor["byteOffset"] = m_bytes[view].size();
  m_bytes[view].append(static_cast<const char*>(values), bytes);
  m_accessors.push_back(std::move(accessor));
  return m_accessors.size() - 1;
}

std::size_t Glb::AddPositions(std::span<const float> values) {
  Json accessor{{"componentType", kFloat}, {"count", values.size() / 3}, {"type", "VEC3"}};
  AddRange(values, accessor);
  return AddAccessor(kVertices, values.data(), values.size_bytes(), std::move(accessor));
}

std::size_t Glb::AddNormals(std::span<const float> values) {
  return AddAccessor(kVertices, values.data(), values.size_bytes(),
                     {{"componentType", kFloat}, {"count", values.size() / 3}, {"type", "VEC3"}});
}

std::size_t Glb::AddIndices(std::span<const std::uint16_t> values) {
  return AddAccessor(kIndices, values.data(), values.size_bytes(),
                     {{"componentType", kUnsignedShort}, {"count", values.size()}, {"type", "SCALAR"}});
}

std::size_t Glb::AddTimes(const std::vector<float>& times) {
  const auto known = m_times.find(times);
  if (known != m_times.end()) return known->second;
  const std::size_t accessor = AddAccessor(kKeys, times.data(), times.size() * sizeof(float),
                                           {{"componentType", kFloat},
                                            {"count", times.size()},
                                            {"type", "SCALAR"},
                                            {"min", Json::array({times.front()})},
                                            {"max", Json::array({times.back()})}});
  m_times.emplace(times, accessor);
  return accessor;
}

std::size_t Glb::AddKeys(std::span<const float> values, const char* type) {
  const std::string name(type);
  const std::size_t width = name == "SCALAR" ? 1 : name == "VEC3" ? 3 : 4;
  return AddAccessor(kKeys, values.data(), values.size_bytes(),
                     {{"componentType", kFloat}, {"count", values.size() / width}, {"type", name}});
}

std::size_t Glb::DescribeBuffer() {
  Json views = Json::array();
  std::array<std::size_t, kViewCount> numbers{};
  std::size_t size = 0;
  for (const View view : {kVertices, kKeys, kIndices}) {
    if (m_bytes[view].empty()) continue;
    numbers[view] = views.size();
    views.push_back({{"buffer", 0}, {"byteOffset", size}, {"byteLength", m_bytes[view].size()}});
    if (view == kVertices) views.back().update({{"byteStride", 3 * sizeof(float)}, {"target", kArrayBuffer}});
    if (view == kIndices) views.back()["target"] = kElementArrayBuffer;
    m_bytes[view].resize(RoundUpToFour(m_bytes[view].size()));
    size += m_bytes[view].size();
  }
  if (views.empty()) return 0;
  for (Json& accessor : m_accessors) accessor["bufferView"] = numbers[accessor["bufferView"].get<std::size_t>()];
  document["accessors"] = std::move(m_accessors);
  document["bufferViews"] = std::move(views);
  document["buffers"] = Json::array({Json{{"byteLength", size}}});
  return size;
}

std::string Glb::Write(const std::filesystem::path& file) {
  const std::size_t size = DescribeBuffer();
  Json whole = Json::object();
  for (auto& [name, value] : document.items()) {
    if (!value.is_array() || !value.empty()) whole[name] = std::move(value);
  }
  // Names may hold any bytes: what is not UTF-8 becomes a replacement character.
  std::string text = whole.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize(RoundUpToFour(text.size()), ' ');
  constexpr std::size_t kFileHead = 12, kChunkHead = 8;
  const std::size_t length = kFileHead + kChunkHead + text.size() + (size > 0 ? kChunkHead + size : 0);
  if (length > std::numeric_limits<std::uint32_t>::max())
    return "would be larger than 4 GiB, the most that .glb can be";
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  out << "glTF";
  WriteNumber(out, 2);
  WriteNumber(out, length);
  WriteNumber(out, text.size());
  out << "JSON" << text;
  if (size > 0) {
    WriteNumber(out, size);
    out.write("BIN\0", 4);
    for (const std::string& bytes : m_bytes) out << bytes;
  }
  out.close();
  return out.good() ? "" : DescribeWriteError();
}

}  // namespace wobble::exporting
