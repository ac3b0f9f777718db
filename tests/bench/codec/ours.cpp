// Our codec, through the entry points that server and client use.
#include <stdexcept>

#include "protocol/codec/encoding/shape_encoder.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/snapshot.h"
#include "tests/bench/codec/method.h"

namespace wobble::bench {
namespace {

using protocol::Vector3;

struct Coder {
  Without without;
  protocol::ShapeEncoder encoder = {};
  protocol::ShapeDecoder decoder = {};
  std::vector<std::uint8_t> payload = {};
  std::vector<Vector3> shape = {};

  std::size_t CodeBody(const server::CapturedBody& body, const Recording& recording, float target,
                       std::vector<Vector3>& shown);
};

std::size_t Coder::CodeBody(const server::CapturedBody& body, const Recording& recording, float target,
                            std::vector<Vector3>& shown) {
  const std::span<const Vector3> rest = recording.blueprint.rest;
  const std::span<const Vector3> vertices = body.vertices;
  std::size_t bytes = 0;
  std::size_t first = 0;
  for (std::size_t patch = 0; first < rest.size(); ++patch) {
    const std::size_t count = protocol::PatchSize(rest.size(), patch);
    protocol::PatchModel model = FindModel(recording, patch);
    if (without == Without::kBasis) model.basis = nullptr;
    if (without == Without::kSurfaces) model.obstacles = {};
    payload.clear();
    shape.resize(count);
    protocol::QuantisedPose pose;
    const bool fits =
        encoder.Encode(model, body.pose, vertices.subspan(first, count), target, protocol::kMaxRecordPayload, payload)
            .fits;
    if (!fits || decoder.Decode(model, payload, pose, shape) != protocol::DecodeResult::kOk) {
      throw std::runtime_error("our codec cannot code or decode a shape");
    }
    const protocol::Pose seen = protocol::Dequantise(pose);
    for (std::size_t i = 0; i < count; ++i) shown[first + i] = protocol::Transform(seen, shape[i]);
    bytes += AddHead(payload.size());
    first += count;
  }
  return bytes;
}

}  // namespace

protocol::PatchModel FindModel(const Recording& recording, std::size_t patch) {
  const server::CapturedBlueprint& blueprint = recording.blueprint;
  return protocol::MakePatchModel(blueprint.rest, blueprint.size, blueprint.patches, patch, recording.obstacles);
}

Method MakeOurs(Without without) {
  const auto begin = [without](const Recording& recording, double share) -> CodeFrame {
    const float target = static_cast<float>(share) * recording.blueprint.size;
    return [&recording, target, coder = Coder{without}](std::size_t frame, Shown& shown) mutable {
      std::size_t bytes = 0;
      for (std::size_t body = 0; body < shown.size(); ++body) {
        bytes += coder.CodeBody(recording.frames[frame][body], recording, target, shown[body]);
      }
      return bytes;
    };
  };
  constexpr const char* kNames[] = {"ours", "ours without basis", "ours without surfaces"};
  return {kNames[static_cast<std::size_t>(without)], {}, begin};
}

}  // namespace wobble::bench
