// Through the entry points that server and client use.
#include <stdexcept>

#include "protocol/shape_codec.h"
#include "protocol/snapshot.h"
#include "tests/bench/codec/method.h"

namespace wobble::bench {
namespace {

using protocol::Vector3;

std::size_t CodeBody(const server::CapturedBody& body, const server::CapturedBlueprint& blueprint, float target,
                     std::vector<Vector3>& shown) {
  const std::span<const Vector3> rest = blueprint.rest;
  const std::span<const Vector3> vertices = body.vertices;
  std::size_t bytes = 0;
  std::size_t first = 0;
  for (std::size_t patch = 0; first < rest.size(); ++patch) {
    const std::size_t count = protocol::PatchSize(rest.size(), patch);
    std::vector<std::uint8_t> payload;
    const protocol::ShapeEncoding encoding =
        protocol::EncodeShape(body.pose, rest.subspan(first, count), vertices.subspan(first, count), target,
                              protocol::kMaxRecordPayload, payload);
    protocol::Pose pose;
    std::vector<Vector3> shape(count);
    if (!encoding.fits ||
        protocol::DecodeShape(payload, rest.subspan(first, count), pose, shape) != protocol::DecodeResult::kOk) {
      throw std::runtime_error("a shape that cannot be coded");
    }
    for (std::size_t i = 0; i < count; ++i) shown[first + i] = protocol::Transform(pose, shape[i]);
    bytes += kRecordHeadBytes + payload.size();
    first += count;
  }
  return bytes;
}

}  // namespace

Method MakeOurs() {
  const auto begin = [](const Recording& recording, double share) -> CodeFrame {
    return
        [&recording, target = static_cast<float>(share) * recording.blueprint.size](std::size_t frame, Shown& shown) {
          std::size_t bytes = 0;
          for (std::size_t body = 0; body < shown.size(); ++body) {
            bytes += CodeBody(recording.frames[frame][body], recording.blueprint, target, shown[body]);
          }
          return bytes;
        };
  };
  return {"ours", {}, begin};
}

}  // namespace wobble::bench
