// The numbers of a body are stored once and named by all that needs them: skins share their vertices, and the nodes of
// skins the samplers of their weights.
#include "server/export/gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "server/export/glb.h"
#include "server/export/normals.h"

namespace wobble::exporting {
namespace {

using Json = Glb::Json;

// The numbers of glTF.
constexpr int kPoints = 0;
constexpr int kLines = 1;
constexpr int kTriangles = 4;

// Linear red, green and blue. Bodies take turns.
constexpr std::array<std::array<double, 3>, 8> kColours{{{0.80, 0.20, 0.05},
                                                         {0.05, 0.35, 0.60},
                                                         {0.15, 0.50, 0.15},
                                                         {0.75, 0.50, 0.08},
                                                         {0.40, 0.18, 0.60},
                                                         {0.10, 0.52, 0.50},
                                                         {0.70, 0.20, 0.35},
                                                         {0.35, 0.38, 0.42}}};

// A document while it grows.
struct Building {
  Glb glb;
  Json nodes = Json::array();
  Json meshes = Json::array();
  Json materials = Json::array();
  Json samplers = Json::array();
  Json channels = Json::array();
  std::map<std::pair<std::size_t, bool>, std::size_t> knownMaterials;  // by colour and isOpen
};

std::size_t FindMaterial(physics::BodyId body, bool isOpen, Building& building) {
  const std::size_t colour = body % kColours.size();
  const auto [known, isNew] = building.knownMaterials.try_emplace({colour, isOpen}, building.materials.size());
  if (isNew) {
    const auto& [red, green, blue] = kColours[colour];
    building.materials.push_back(
        {{"pbrMetallicRoughness",
          {{"baseColorFactor", {red, green, blue, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.6}}},
         {"doubleSided", isOpen}});
  }
  return known->second;
}

std::size_t AddSampler(std::size_t times, std::size_t values, const char* interpolation, Building& building) {
  building.samplers.push_back({{"input", times}, {"output", values}, {"interpolation", interpolation}});
  return building.samplers.size() - 1;
}

void AddChannel(std::size_t sampler, std::size_t node, const char* path, Building& building) {
  building.channels.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

// Scale 0 while it is not there.
void Show(const Span& span, std::size_t node, Building& building) {
  const bool comes = span.from > 0;
  const bool goes = std::isfinite(span.to);
  if (!comes && !goes) return;
  std::vector<float> times, scales;
  const auto add = [&](float time, float scale) {
    times.push_back(time);
    scales.insert(scales.end(), 3, scale);
  };
  if (comes) add(0, 0);
  add(span.from, 1);
  if (goes) add(span.to, 0);
  if (comes) building.nodes[node]["scale"] = {0, 0, 0};
  const std::size_t output = building.glb.AddKeys(scales, "VEC3");
  AddChannel(AddSampler(building.glb.AddTimes(times), output, "STEP", building), node, "scale", building);
}

// The values of all keys of a part, `width` numbers each.
struct Track {
  std::vector<float> values;
  std::size_t width = 1;

  [[nodiscard]] bool IsConstant() const {
    return std::equal(values.begin() + static_cast<std::ptrdiff_t>(width), values.end(), values.begin());
  }
  [[nodiscard]] std::vector<float> First() const {
    return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(width)};
  }
};

// Returns the number of the sampler; nullopt: the values never change.
std::optional<std::size_t> AddMotion(const Part& part, const Track& track, const char* type, Building& building) {
  if (track.IsConstant()) return {};
  std::vector<float> times;
  for (const Key& key : part.keys) times.push_back(key.time);
  const std::size_t output = building.glb.AddKeys(track.values, type);
  return AddSampler(building.glb.AddTimes(times), output, "LINEAR", building);
}

// Gives the node the first key's pose, and moves it.
void MoveNode(const Part& part, std::size_t node, Building& building) {
  Track centres{.values = {}, .width = 3}, rotations{.values = {}, .width = 4};
  for (const Key& key : part.keys) {
    centres.values.insert(centres.values.end(), key.centre.begin(), key.centre.end());
    const auto& q = key.rotation.coeffs();
    rotations.values.insert(rotations.values.end(), q.begin(), q.end());
  }
  building.nodes[node]["translation"] = centres.First();
  building.nodes[node]["rotation"] = rotations.First();
  if (const auto sampler = AddMotion(part, centres, "VEC3", building))
    AddChannel(*sampler, node, "translation", building);
  if (const auto sampler = AddMotion(part, rotations, "VEC4", building))
    AddChannel(*sampler, node, "rotation", building);
}

template <class Corners>
Json MakePrimitive(int mode, const std::vector<Corners>& cells, const Json& shape, std::size_t material,
                   Building& building) {
  std::vector<std::uint16_t> corners;
  for (const Corners& cell : cells) corners.insert(corners.end(), cell.begin(), cell.end());
  Json primitive = shape;
  primitive["indices"] = building.glb.AddIndices(corners);
  primitive["material"] = material;
  primitive["mode"] = mode;
  return primitive;
}

// The skeleton in places among the part's vertices.
Skeleton Renumber(Skeleton skeleton, const std::vector<std::uint16_t>& vertices) {
  const auto place = [&](std::uint16_t& vertex) {
    vertex = static_cast<std::uint16_t>(std::ranges::lower_bound(vertices, vertex) - vertices.begin());
  };
  for (physics::Face& face : skeleton.faces) std::ranges::for_each(face, place);
  for (physics::EdgeEnds& line : skeleton.lines) std::ranges::for_each(line, place);
  std::ranges::for_each(skeleton.points, place);
  return skeleton;
}

// What all primitives of a part share: its vertices and morph targets.
Json AddShape(const Part& part, const Skeleton& first, const Eigen::Ref<const Eigen::MatrixXf>& departures,
              const Modes& modes, Building& building) {
  Json shape{{"attributes", {{"POSITION", building.glb.AddPositions(part.rest)}}}};
  Json targets = Json::array();
  for (Eigen::Index mode = 0; mode < modes.shapes.cols(); ++mode) {
    const auto column = static_cast<std::size_t>(mode * modes.shapes.rows());
    targets.push_back({{"POSITION", building.glb.AddPositions({modes.shapes.data() + column, part.rest.size()})}});
  }
  if (!first.faces.empty()) {
    const std::vector<float> normals = FindNormals(part.rest, first.faces);
    shape["attributes"]["NORMAL"] = building.glb.AddNormals(normals);
    const auto changes = FindNormalModes(departures, modes, part.rest, normals, first.faces);
    for (std::size_t mode = 0; mode < changes.size(); ++mode) {
      targets[mode]["NORMAL"] = building.glb.AddNormals(changes[mode]);
    }
  }
  if (!targets.empty()) shape["targets"] = std::move(targets);
  return shape;
}

std::size_t AddMesh(const Part& part, const Skin& skin, const Json& shape, Building& building) {
  const Skeleton skeleton = Renumber(skin.skeleton, part.vertices);
  const std::size_t material = FindMaterial(part.body, skin.isOpen, building);
  Json mesh{{"primitives", Json::array()}};
  const auto add = [&](int mode, const auto& cells) {
    if (!cells.empty()) mesh["primitives"].push_back(MakePrimitive(mode, cells, shape, material, building));
  };
  std::vector<std::array<std::uint16_t, 1>> points;
  for (const std::uint16_t point : skeleton.points) points.push_back({point});
  add(kTriangles, skeleton.faces);
  add(kLines, skeleton.lines);
  add(kPoints, points);
  building.meshes.push_back(std::move(mesh));
  return building.meshes.size() - 1;
}

// The weights of all keys.
Track FindWeights(const Part& part, const Modes& modes) {
  Track track{.values = {}, .width = static_cast<std::size_t>(modes.weights.rows())};
  for (const Key& key : part.keys) {
    const auto column = modes.weights.col(key.shape);
    track.values.insert(track.values.end(), column.begin(), column.end());
  }
  return track;
}

// Gives the part's skins to its node: one to the node itself, several to children of it.
void AddSkins(const Part& part, const Json& shape, const Modes& modes, std::size_t node, Building& building) {
  const Track weights = FindWeights(part, modes);
  const bool hasModes = weights.width > 0;
  const auto sampler = hasModes ? AddMotion(part, weights, "SCALAR", building) : std::nullopt;
  for (const Skin& skin : part.skins) {
    std::size_t holder = node;
    if (part.skins.size() > 1) {
      holder = building.nodes.size();
      building.nodes.push_back({{"name", fmt::format("{} from {:.2f} s", part.blueprint, skin.span.from)}});
      building.nodes[node]["children"].push_back(holder);
      // The whole part comes and goes with its own node.
      Show({.from = skin.span.from > part.span.from ? skin.span.from : 0,
            .to = skin.span.to < part.span.to ? skin.span.to : Span{}.to},
           holder, building);
    }
    building.nodes[holder]["mesh"] = AddMesh(part, skin, shape, building);
    if (hasModes) building.nodes[holder]["weights"] = weights.First();
    if (sampler) AddChannel(*sampler, holder, "weights", building);
  }
}

// As shares of the size.
struct Errors {
  double overall = 0;
  double worst = 0;  // of one frame
};

Errors AddPart(const Part& part, double maxError, Building& building) {
  const double size = std::max(part.size, physics::kMinSize);
  const auto rows = static_cast<Eigen::Index>(part.rest.size());
  const Eigen::Map<const Eigen::MatrixXf> departures(part.shapes.data(), rows,
                                                     static_cast<Eigen::Index>(part.shapes.size()) / rows);
  const Modes modes = FindModes(departures, maxError * size);
  const std::size_t node = building.nodes.size();
  const std::string player = part.player.empty() ? "" : fmt::format(" ({})", part.player);
  building.nodes.push_back({{"name", fmt::format("{} {}{}", part.blueprint, part.body, player)},
                            {"extras",
                             {{"body", part.body},
                              {"size", part.size},
                              {"morphTargets", modes.weights.rows()},
                              {"error", modes.error},
                              {"worstError", modes.worstError}}}});
  building.nodes[0]["children"].push_back(node);
  Show(part.span, node, building);
  MoveNode(part, node, building);
  const Skeleton first = Renumber(part.skins.front().skeleton, part.vertices);
  AddSkins(part, AddShape(part, first, departures, modes, building), modes, node, building);
  return {modes.error / size, modes.worstError / size};
}

}  // namespace

GltfWriter::GltfWriter(std::filesystem::path file, std::string scene, const GltfLimits& limits)
    : m_file(std::move(file)), m_scene(std::move(scene)), m_limits(limits) {}

std::string GltfWriter::Add(const Frame& frame) {
  m_clip.Add(frame);
  if (m_clip.IsTooLong()) {
    return fmt::format(
        "at {:.2f} s: glTF cannot tell frames apart so long after the first; choose fewer with --fps, "
        "or an earlier end with --to",
        frame.time);
  }
  if (m_clip.Bytes() <= m_limits.shapeBytes) return {};
  return fmt::format(
      "the shapes up to {:.2f} s fill the {:.3g} MiB that glTF export has for them; choose less with --from and --to, "
      "--fps "
      "or --bodies",
      frame.time, static_cast<double>(m_limits.shapeBytes) / (1 << 20));
}

std::string GltfWriter::Finish() {
  Building building;
  const double half = std::sqrt(0.5);
  building.nodes.push_back({{"name", m_scene}, {"rotation", {-half, 0, 0, half}}});
  Errors errors;
  for (Part& part : m_clip.Parts()) {
    const Errors found = AddPart(part, m_limits.error, building);
    errors = {std::max(errors.overall, found.overall), std::max(errors.worst, found.worst)};
    part = {};  // frees its shapes
  }
  Json& document = building.glb.document;
  document["asset"] = {{"version", "2.0"},
                       {"generator", "wobble"},
                       {"extras",
                        {{"units", "m, s"},
                         {"axes", "y up; the root node turns the scene's, z up"},
                         {"errorBound", m_limits.error},
                         {"error", errors.overall},
                         {"worstError", errors.worst},
                         {"errorMeans",
                          "of the worst body, as a share of its size: RMS over its vertices in all frames, "
                          "and in the worst frame"}}}};
  document["scene"] = 0;
  document["scenes"] = Json::array({Json{{"name", m_scene}, {"nodes", Json::array({0})}}});
  document["nodes"] = std::move(building.nodes);
  document["meshes"] = std::move(building.meshes);
  document["materials"] = std::move(building.materials);
  document["animations"] = Json::array();
  if (!building.channels.empty()) {
    document["animations"].push_back(
        {{"name", m_scene}, {"samplers", std::move(building.samplers)}, {"channels", std::move(building.channels)}});
  }
  return building.glb.Write(m_file);
}

}  // namespace wobble::exporting
