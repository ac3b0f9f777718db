// An animation in glTF is read back, as a viewer would, and compared with the recording that is played again.
#include <gmock/gmock.h>

#include <array>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "server/export/gltf.h"
#include "server/export/walk.h"
#include "tests/support/places.h"
#include "tests/unit/recording/matches.h"

namespace wobble::exporting {
namespace {

using nlohmann::json;
using physics::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;

// A .glb file's document and numbers.
class Document {
 public:
  explicit Document(const std::filesystem::path& file) : m_bytes(recording::ReadFile(file)) {
    EXPECT_EQ(std::string(m_bytes.begin(), m_bytes.begin() + 4), "glTF");
    EXPECT_EQ(ReadWord(8), m_bytes.size());
    const std::size_t length = ReadWord(12);
    root = json::parse(m_bytes.begin() + 20, m_bytes.begin() + 20 + static_cast<std::ptrdiff_t>(length));
    m_numbers = 20 + length + 8;
  }
  [[nodiscard]] std::vector<float> Read(std::size_t number) const {
    const json& accessor = root["accessors"][number];
    static const std::map<std::string, std::size_t> kWidths{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
    std::vector<float> values(accessor["count"].get<std::size_t>() * kWidths.at(accessor["type"]));
    std::memcpy(values.data(), m_bytes.data() + FindPlace(accessor), values.size() * sizeof(float));
    return values;
  }
  [[nodiscard]] std::size_t CountTriangles(const json& mesh) const {
    std::size_t count = 0;
    for (const json& primitive : mesh["primitives"]) {
      if (primitive["mode"] == 4)
        count += root["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>() / 3;
    }
    return count;
  }
  // What an animation gives the node at a time between two of its keys or on one; empty: it is not animated.
  [[nodiscard]] std::vector<float> Sample(std::size_t node, const char* path, float time) const {
    for (const json& channel : root["animations"][0]["channels"]) {
      if (channel["target"]["node"] != node || channel["target"]["path"] != path) continue;
      const json& sampler = root["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()];
      const std::vector<float> times = Read(sampler["input"]), values = Read(sampler["output"]);
      const std::size_t width = values.size() / times.size();
      const auto after = std::ranges::upper_bound(times, time);
      const auto key = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - times.begin() - 1));
      // A frame is a key, or in a stretch in which nothing changes.
      if (sampler["interpolation"] == "LINEAR" && times[key] != time && key + 1 < times.size() && times[key] <= time) {
        for (std::size_t i = 0; i < width; ++i) EXPECT_EQ(values[key * width + i], values[(key + 1) * width + i]);
      }
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(key * width);
      return {begin, begin + static_cast<std::ptrdiff_t>(width)};
    }
    return {};
  }
  // The same, or what the node itself has.
  [[nodiscard]] std::vector<float> SampleOrRead(std::size_t node, const char* path, float time) const {
    const std::vector<float> sampled = Sample(node, path, time);
    return sampled.empty() ? root["nodes"][node].value(path, std::vector<float>{}) : sampled;
  }
  [[nodiscard]] bool IsShown(std::size_t node, float time) const {
    const std::vector<float> scale = SampleOrRead(node, "scale", time);
    return scale.empty() || scale[0] == 1;
  }

  json root;

 private:
  [[nodiscard]] std::size_t ReadWord(std::size_t at) const {
    std::uint32_t word = 0;
    std::memcpy(&word, m_bytes.data() + at, sizeof word);
    return word;
  }
  [[nodiscard]] std::size_t FindPlace(const json& accessor) const {
    return m_numbers + root["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() +
           accessor["byteOffset"].get<std::size_t>();
  }

  recording::Bytes m_bytes;
  std::size_t m_numbers = 0;  // where they begin
};

// A node of a body and the node of the mesh that it shows at a time.
struct Shown {
  std::size_t node = 0;
  std::size_t holder = 0;
};

std::vector<Shown> FindShown(const Document& document, physics::BodyId body, float time) {
  std::vector<Shown> shown;
  for (const std::size_t node : document.root["nodes"][0]["children"]) {
    const json& each = document.root["nodes"][node];
    if (each["extras"]["body"] != body || !document.IsShown(node, time)) continue;
    if (each.contains("mesh")) shown.push_back({node, node});
    for (const std::size_t child : each.value("children", std::vector<std::size_t>{})) {
      if (document.IsShown(child, time)) shown.push_back({node, child});
    }
  }
  return shown;
}

// The vertices that are shown, in the world.
std::vector<Vector3d> Decode(const Document& document, const Shown& shown, float time) {
  const json& mesh = document.root["meshes"][document.root["nodes"][shown.holder]["mesh"].get<std::size_t>()];
  const json& primitive = mesh["primitives"][0];
  std::vector<float> local = document.Read(primitive["attributes"]["POSITION"]);
  const std::vector<float> weights = document.SampleOrRead(shown.holder, "weights", time);
  for (std::size_t mode = 0; mode < weights.size(); ++mode) {
    const std::vector<float> target = document.Read(primitive["targets"][mode]["POSITION"]);
    for (std::size_t i = 0; i < local.size(); ++i) local[i] += weights[mode] * target[i];
  }
  const std::vector<float> at = document.SampleOrRead(shown.node, "translation", time);
  const std::vector<float> q = document.SampleOrRead(shown.node, "rotation", time);
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  std::vector<Vector3d> vertices;
  for (std::size_t i = 0; i < local.size(); i += 3) {
    vertices.push_back(rotation * Vector3d(local[i], local[i + 1], local[i + 2]) + Vector3d(at[0], at[1], at[2]));
  }
  return vertices;
}

class Gltf : public testing::Test {
 protected:
  // scene: of a stored recording.
  Document Export(const std::string& scene, const WalkSettings& settings) {
    Play(scene, settings, {});
    EXPECT_THAT(walked.error + walked.outputError, IsEmpty());
    return Document(folder.Path() / "film.glb");
  }
  void Play(const std::string& scene, const WalkSettings& settings, const GltfLimits& limits) {
    std::string error;
    EXPECT_THAT(played.Open(test::FindSource(std::string("tests/determinism/recordings/") + scene + ".wobrec")),
                IsEmpty());
    ground = recording::MakeGround(played.ReadHead(), {}, error);
    replay = std::make_unique<recording::Replay>(played, *ground);
    plan = *MakePlan(played, settings, error);
    GltfWriter writer(folder.Path() / "film.glb", "a scene", limits);
    walked = Walk(played, *replay, *ground, settings, plan, writer, [](double, double) { return true; });
  }
  // Every body in every frame is shown once and lies where it was played, to within the stated error of its node, with
  // as many faces as it then had. Returns the most morph targets.
  std::size_t Compare(const Document& document) {
    std::size_t targets = 0;
    for (std::uint32_t frame = 0; frame < plan.frames; ++frame) {
      EXPECT_THAT(replay->Seek(plan.TickOf(frame)), IsEmpty());
      const auto time = static_cast<float>(played.TimeOf(plan.TickOf(frame)) - played.TimeOf(plan.firstTick));
      for (const physics::Body& body : ground->World().Bodies()) {
        const std::vector<Shown> shown = FindShown(document, body.id, time);
        EXPECT_EQ(shown.size(), 1U) << "body " << body.id << " at " << time;
        if (shown.size() != 1) return 0;
        CompareBody(document, shown[0], body, time);
        targets = std::max(targets, document.root["nodes"][shown[0].node]["extras"]["morphTargets"].get<std::size_t>());
      }
    }
    return targets;
  }
  void CompareBody(const Document& document, const Shown& shown, const physics::Body& body, float time) {
    const physics::Blueprint& blueprint = ground->World().BlueprintOf(body);
    const json& extras = document.root["nodes"][shown.node]["extras"];
    const json& mesh = document.root["meshes"][document.root["nodes"][shown.holder]["mesh"].get<std::size_t>()];
    EXPECT_EQ(document.CountTriangles(mesh), blueprint.full.faces.size());
    const std::vector<Vector3d> decoded = Decode(document, shown, time);
    std::vector<Vector3d> wanted;
    physics::VisitVertices(body, [&](std::size_t, const Vector3d& x) { wanted.push_back(x); });
    ASSERT_EQ(decoded.size(), wanted.size()) << "all of them are on the skin in these scenes";
    double squares = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) squares += (decoded[i] - wanted[i]).squaredNorm();
    const double error = std::sqrt(squares / static_cast<double>(wanted.size()));
    EXPECT_LE(error, extras["worstError"].get<double>() + 1e-5) << "body " << body.id << " at " << time;
    EXPECT_LE(extras["error"].get<double>(), 0.005 * std::max(blueprint.size, 0.01));
  }

  recording::Folder folder;
  recording::Recording played;
  std::unique_ptr<server::Playground> ground;
  std::unique_ptr<recording::Replay> replay;
  Plan plan;
  Walked walked;
};

TEST_F(Gltf, ACurtainThatIsCutLiesWhereItWasPlayed) {
  const Document document = Export("curtain", {.from = 0.1, .fps = 15});
  EXPECT_GT(Compare(document), 2U);
  const double error = document.root["asset"]["extras"]["error"];
  EXPECT_GT(error, 0.0005);
  EXPECT_LE(error, 0.005);
  const auto hasTorn = std::ranges::any_of(document.root["nodes"][0]["children"], [&](const json& node) {
    return document.root["nodes"][node.get<std::size_t>()].value("children", json::array()).size() > 1;
  });
  EXPECT_TRUE(hasTorn) << "it has another skin after each cut";
  EXPECT_EQ(document.root["nodes"].back().contains("scale"), true) << "what comes later is not there at first";
}

TEST_F(Gltf, BodiesWithoutFacesAreLines) {
  const Document document = Export("pair", {});
  Compare(document);
  EXPECT_EQ(document.root["meshes"][0]["primitives"][0]["mode"], 1);
  EXPECT_THAT(document.root["nodes"].dump(), HasSubstr("(Ada)")) << "players are named";
}

TEST_F(Gltf, WhatDoesNotFitIsRefusedByItsLimit) {
  Play("curtain", {.to = 1}, {.shapeBytes = 1 << 16});
  EXPECT_THAT(walked.outputError,
              HasSubstr("fill the 0.0625 MiB that glTF export has for them; choose less with --from"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "film.glb"));
}

}  // namespace
}  // namespace wobble::exporting
