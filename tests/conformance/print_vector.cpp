// Prints the code blocks of protocol/STANDARD.md that the native code can make: the tables of contexts, and the test
// vector of section 11. A test compares them with the document; after a change of the format they are what to put
// there.
//
// The body is that of the golden bytes of the shape codec's tests: four vertices above a floor, of which contact
// presses one, in a basis of cosines.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

#include "client/wasm/decoded_hash.h"
#include "protocol/codec/basis_reader.h"
#include "protocol/codec/contexts.h"
#include "protocol/codec/encoding/shape_encoder.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/snapshot.h"

namespace {

using namespace wobble;
using protocol::Vector3;

void PrintBytes(const char* name, std::span<const std::uint8_t> bytes) {
  std::printf("```text %s\n", name);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::printf("%02x%s", bytes[i], i % 32 == 31 || i + 1 == bytes.size() ? "\n" : " ");
  }
  std::printf("```\n\n");
}

void PrintTables() {
  std::printf("```text expectations\n");
  for (std::size_t i = 0; i < protocol::kExpectations.size(); ++i) {
    std::printf("%u%s", protocol::kExpectations[i], i % 8 == 7 || i + 1 == protocol::kExpectations.size() ? "\n" : " ");
  }
  std::printf("```\n\n```text magnitude-frequencies\n");
  for (std::size_t context = 0; context < protocol::kContexts; ++context) {
    std::printf("%2zu:", context);
    for (const protocol::Frequency& each : protocol::FindFrequencies(context)) std::printf(" %u", each.size);
    std::printf("\n");
  }
  std::printf("```\n\n");
}

// Two modes as bytes, and three blocks of the rest, each turned by its matrix: all that a trained basis has.
std::vector<std::uint8_t> MakeBasisBytes() {
  protocol::BasisSource source;
  source.kind = protocol::BasisSource::Kind::kFull;
  source.vertices = 4;
  source.modes = {10, 0, 60, -20, 0, 70, 0, 10, 50, 30, -10, 127, 0, 90, 0, 20, -80, 0, 100, 10, 0, -40, 0, -30};
  source.order = {2, 0, 3, 1};
  source.blocks = 3;
  source.turns = {7, -2, 0, 3,  6, 1,  -1, 2, 5, 4, -4, 2, 6, 5, -1, -3, 2,
                  7, 7,  1, -2, 0, -1, 6,  3, 2, 2, -5, 7, 1, 0, 3,  -3, 4};
  for (int i = 0; i < 12; ++i) source.levels.push_back(static_cast<std::uint8_t>(protocol::kLevelZero - 8 - 3 * i));
  for (int i = 0; i < 12; ++i) source.gains.push_back(static_cast<std::int8_t>(i < 9 ? 60 - 4 * i : 0));
  return protocol::WriteBasis(source);
}

void PrintVector() {
  const std::array<Vector3, 4> rest{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}}};
  const protocol::Pose pose{{1.5F, -2.25F, 2.75F}, {0.8F, 0, 0.6F, 0}};
  constexpr float kSize = 1.25F;
  constexpr float kFloor = 2;
  constexpr std::uint32_t kBody = 7, kTick = 120;

  protocol::WelcomeFields welcome{.clientId = 1,
                                  .tick = 118,
                                  .tickHz = 60,
                                  .snapshotHz = 30,
                                  .scene = "vector",
                                  .blueprintCount = 1,
                                  .obstacles = {}};
  welcome.obstacles.emplace_back(protocol::wire::ObstacleKind::Box, protocol::wire::Vec3(0, 0, 1),
                                 protocol::wire::Vec3(9, 9, 1), 0.0F);
  const std::vector<std::vector<std::uint8_t>> bases{MakeBasisBytes()};
  const protocol::Message blueprint =
      protocol::MakeBlueprint({.name = "tetra", .rest = rest, .size = kSize, .bases = bases});
  const auto basis = protocol::ReadBasis(bases[0], rest.size());
  const protocol::PatchModel model{.rest = rest,
                                   .size = kSize,
                                   .basis = basis.get(),
                                   .obstacles = welcome.obstacles,
                                   .reach = protocol::FindReach(rest)};

  std::vector<Vector3> vertices;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    vertices.push_back(protocol::Transform(pose, rest[i] * 1.125F));
    vertices.back().z = std::max(vertices.back().z, kFloor);
  }
  protocol::ShapeEncoder encoder;
  std::vector<std::uint8_t> payload, record;
  static_cast<void>(encoder.Encode(model, pose, vertices, 0.01F, protocol::kMaxRecordPayload, payload));
  protocol::AppendRecord({.body = kBody}, payload, record);
  protocol::PacketBuilder packet;
  static_cast<void>(packet.Add(record));

  PrintBytes("vector-welcome", protocol::MakeWelcome(welcome));
  PrintBytes("vector-blueprint",
             protocol::MakeBlueprintChunk(0, protocol::HashBytes(blueprint),
                                          static_cast<std::uint32_t>(blueprint.size()), 0, blueprint));
  PrintBytes("vector-packet", packet.Finish({.sequence = 1, .tick = kTick, .timeRatio = 1, .inputTick = 0}));

  protocol::ShapeDecoder decoder;
  protocol::QuantisedPose decodedPose;
  std::vector<Vector3> shape(rest.size());
  static_cast<void>(decoder.Decode(model, payload, decodedPose, shape));
  std::printf("```text vector-vertices\n");
  for (const Vector3& v : shape) {
    std::printf("%08x %08x %08x\n", std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
                std::bit_cast<std::uint32_t>(v.z));
  }
  wasm::DecodedHash hash;
  hash.Add({.body = kBody, .tick = kTick, .pose = protocol::Dequantise(decodedPose), .shape = shape});
  std::printf("```\n\n```text vector-hash\n%016llx\n```\n", static_cast<unsigned long long>(hash.Value()));
}

}  // namespace

int main() {
  PrintTables();
  PrintVector();
}
