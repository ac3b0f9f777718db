// Small worlds and records, as hashes: those of 64-bit ARM, where `make test` runs this by an emulator, must be those
// of x86. It is small because all that it is made of is compiled for ARM anew; `make nightly` has the golden scenes
// there.
//
//   bits_test FILE     compares with the file; exit 1 when any differs
//   bits_test --write  prints what the file holds
#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "protocol/codec/basis_reader.h"
#include "protocol/codec/encoding/crowd_encoder.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/limits.h"
#include "protocol/messages.h"
#include "protocol/snapshot.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/solid.h"
#include "server/physics/world.h"

namespace {

using namespace wobble;
using physics::Vector3d;

constexpr int kTicks = 6;

physics::Blueprint MakeSmallBall(physics::Integrator integrator) {
  physics::BallDefinition definition;
  definition.subdivisions = 0;
  physics::Blueprint ball = physics::MakeBall(definition);
  physics::SetIntegrator(ball, integrator);
  return ball;
}

physics::Blueprint MakeCurtain() {
  physics::ClothDefinition definition;
  definition.points = {4, 3};
  definition.pinned = physics::Pinned::kCorners;
  return physics::MakeCloth(definition);
}

physics::Blueprint MakeBlock() {
  physics::SolidDefinition definition;
  definition.cells = {1, 1, 1};
  return physics::MakeSolid(definition);
}

// Bodies of one blueprint that fall onto the ground, and onto one another where they are closer than a metre.
std::uint64_t Play(const physics::Blueprint& blueprint, int bodies, double distance, int lanes) {
  physics::WorldSettings settings;
  settings.widestPack = lanes;
  physics::World world(settings);
  world.AddBlueprint(blueprint);
  world.AddObstacle({});
  for (int i = 0; i < bodies; ++i) {
    world.AddBody(0, Vector3d(distance * (i % 3), distance * (i / 3), 0.6 + 0.05 * i), Vector3d(1 - i, i - 1, -4));
  }
  for (int tick = 0; tick < kTicks; ++tick) world.Step();
  return world.Hash();
}

// The records of a crowd of bodies that are pressed out of shape, and what is decoded from them. All inputs are exact.
std::uint64_t Code(protocol::BasisSource::Kind kind) {
  constexpr std::size_t kVertices = 42, kBodies = 9;
  std::mt19937 random(26);
  const auto draw = [&] { return static_cast<float>(static_cast<int>(random() % 2048) - 1024) / 1024; };
  protocol::BasisSource source;
  source.kind = kind;
  source.vertices = kVertices;
  if (kind == protocol::BasisSource::Kind::kCosine) {
    source.grid = {3, kVertices / 6, 2};
  } else {
    const std::size_t rows = kind == protocol::BasisSource::Kind::kFull ? 3 * kVertices : kVertices;
    for (std::size_t i = 0; i < 5 * rows; ++i) source.modes.push_back(static_cast<std::int8_t>(random() % 255) - 127);
    for (std::size_t i = 0; i < kVertices; ++i) source.order.push_back(static_cast<std::uint16_t>(kVertices - 1 - i));
  }
  source.levels.assign(3 * kVertices, static_cast<std::uint8_t>(protocol::kLevelZero - 24));
  source.gains.assign(3 * kVertices, 48);
  const auto basis = protocol::ReadBasis(protocol::WriteBasis(source), kVertices);

  std::vector<protocol::Vector3> rest(kVertices);
  for (auto& vertex : rest) vertex = {draw(), draw(), draw()};
  const std::vector<protocol::wire::Obstacle> floor{{protocol::wire::ObstacleKind::Box, {0, 0, -1.5F}, {50, 50, 1}, 0}};
  const protocol::PatchModel model{
      .rest = rest, .size = 1, .basis = basis.get(), .obstacles = floor, .reach = protocol::FindReach(rest)};
  std::vector<std::vector<protocol::Vector3>> shapes(kBodies, rest);
  std::vector<std::vector<std::uint8_t>> payloads(kBodies);
  std::vector<protocol::CrowdBody> bodies;
  for (std::size_t i = 0; i < kBodies; ++i) {
    for (auto& vertex : shapes[i]) vertex = vertex + protocol::Vector3{draw(), draw(), draw()} * 0.125F;
    bodies.push_back({.pose = {{}, {0.8F, 0, 0.6F, 0}},
                      .vertices = shapes[i],
                      .targetRms = 0.0078125F,
                      .out = &payloads[i],
                      .encoding = {}});
  }
  protocol::CrowdEncoder crowd;
  crowd.Encode(model, protocol::kMaxRecordPayload, bodies);

  std::vector<std::uint8_t> all;
  for (const auto& payload : payloads) {
    protocol::ShapeDecoder decoder;
    protocol::QuantisedPose pose;
    std::vector<protocol::Vector3> shape(kVertices);
    if (decoder.Decode(model, payload, pose, shape) != protocol::DecodeResult::kOk) return 0;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(shape.data());
    all.insert(all.end(), payload.begin(), payload.end());
    all.insert(all.end(), bytes, bytes + shape.size() * sizeof shape[0]);
  }
  return protocol::HashBytes(all);
}

std::string ListHashes() {
  using physics::Integrator;
  const auto ball = MakeSmallBall(Integrator::kRungeKutta4);
  const std::pair<const char*, std::uint64_t> hashes[] = {
      {"balls_apart", Play(ball, 9, 2, 16)},
      {"balls_apart_by_one", Play(ball, 9, 2, 1)},
      {"balls_in_a_heap", Play(ball, 9, 0.9, 16)},
      {"balls_semi_implicit", Play(MakeSmallBall(Integrator::kSemiImplicitEuler), 5, 0.9, 16)},
      {"curtains", Play(MakeCurtain(), 3, 0.3, 16)},
      {"solids", Play(MakeBlock(), 2, 0.9, 16)},
      {"codec_full", Code(protocol::BasisSource::Kind::kFull)},
      {"codec_scalar", Code(protocol::BasisSource::Kind::kScalar)},
      {"codec_cosine", Code(protocol::BasisSource::Kind::kCosine)},
  };
  std::string lines;
  for (const auto& [name, hash] : hashes) {
    char line[64];
    std::snprintf(line, sizeof line, "%s %016" PRIx64 "\n", name, hash);
    lines += line;
  }
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: bits_test FILE|--write\n");
    return 2;
  }
  const std::string hashes = ListHashes();
  if (std::strcmp(argv[1], "--write") == 0) {
    std::fputs(hashes.c_str(), stdout);
    return 0;
  }
  std::ifstream file(argv[1]);
  const std::string wanted(std::istreambuf_iterator<char>(file), {});
  if (hashes == wanted) return 0;
  std::printf("expected (%s):\n%s\nhere:\n%s", argv[1], wanted.c_str(), hashes.c_str());
  return 1;
}
