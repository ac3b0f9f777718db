// One shape payload: the first byte chooses the vertex count (1 to 64), the rest is decoded.
//
// Beyond memory safety: what decodes is finite, turns by a unit rotation, and stays within the largest residual.
#include "protocol/shape_codec.h"

#include <cmath>

#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

using protocol::Vector3;

void FuzzOne(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const std::vector<Vector3> rest(1 + bytes[0] % 64, Vector3{1, 0, -1});
  std::vector<Vector3> shape(rest.size());
  protocol::Pose pose;
  if (protocol::DecodeShape(bytes.subspan(1), rest, pose, shape) != protocol::DecodeResult::kOk) return;
  const auto q = pose.rotation;
  Require(std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-5F);
  Require(protocol::Length(pose.centroid) < 8192 * 1.7321F + 1);
  for (const Vector3& v : shape) {
    // 2^21 steps of at most 7/4 m, and the rest shape's 1 m.
    Require(std::fabs(v.x) < 3.7e6F && std::fabs(v.y) < 3.7e6F && std::fabs(v.z) < 3.7e6F);
  }
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
