// One shape payload: the first byte chooses the basis, or none, and the vertex count; the others are decoded.
//
// Beyond memory safety: a decoded shape is finite with a unit rotation, and DecodePose reads the same pose.
#include "protocol/codec/shape_codec.h"

#include <cmath>

#include "tests/fuzz/bases.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

using protocol::Vector3;

void FuzzOne(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  static const auto kObstacles =
      std::vector<protocol::wire::Obstacle>{{protocol::wire::ObstacleKind::Box, {0, 0, -1}, {9, 9, 1}, 0},
                                            {protocol::wire::ObstacleKind::Plane, {0.6F, 0, 0.8F}, {-2, 0, 0}, 0},
                                            {protocol::wire::ObstacleKind::Sphere, {1, 1, 1}, {}, 1}};
  static const std::array<std::shared_ptr<const protocol::Basis>, 4> kBases = {nullptr, MakeBasis(0, 6),
                                                                               MakeBasis(1, 6), MakeBasis(2, 6)};
  const protocol::Basis* basis = kBases[bytes[0] % 4].get();
  const std::vector<Vector3> rest(basis != nullptr ? 6U : 1U + bytes[0] / 4U, Vector3{1, 0, -1});
  const protocol::PatchModel model{
      .rest = rest, .size = 1.4F, .basis = basis, .obstacles = kObstacles, .reach = protocol::FindReach(rest)};
  static protocol::ShapeDecoder decoder;
  std::vector<Vector3> shape(rest.size());
  protocol::QuantisedPose read;
  const std::vector<std::uint8_t> payload(bytes.begin() + 1,
                                          bytes.end());  // a copy, so that a read past its end is seen
  if (decoder.Decode(model, payload, read, shape) != protocol::DecodeResult::kOk) return;
  const protocol::Pose pose = protocol::Dequantise(read);
  const auto q = pose.rotation;
  Require(std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-5F);
  Require(protocol::Length(pose.centroid) < 8192 * 1.7321F + 1);
  for (const Vector3& v : shape) Require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
  protocol::QuantisedPose alone;
  Require(protocol::DecodePose(payload, model.size, alone) == protocol::DecodeResult::kOk);
  Require(alone.x == read.x && alone.y == read.y && alone.z == read.z && alone.largest == read.largest);
  Require(protocol::Dequantise(alone).centroid.x == pose.centroid.x);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
