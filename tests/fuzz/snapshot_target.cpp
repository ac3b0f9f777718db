// A snapshot packet, read as by a client: the head, every record in place, every record's shape decoded.
//
// The vertex count follows from the record's blueprint and patch, so that one input reaches small and full patches.
// Beyond memory safety it requires what ReadSnapshot promises: payloads inside the packet, in order, to its end.
#include "protocol/snapshot.h"

#include <array>
#include <cmath>

#include "protocol/codec/shape_codec.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

using protocol::Vector3;

void FuzzOne(std::span<const std::uint8_t> bytes) {
  static const std::vector<Vector3> kRest(protocol::kMaxPatchVertices, Vector3{0.5F, -0.5F, 0.25F});
  static std::vector<Vector3> shape(protocol::kMaxPatchVertices);
  protocol::SnapshotHead head;
  std::vector<protocol::Record> records;
  const auto result = protocol::ReadSnapshot(bytes, head, records);
  const std::uint8_t* end = bytes.data();
  for (const protocol::Record& record : records) {
    Require(record.payload.data() > end && !record.payload.empty() && record.head.body != 0);
    end = record.payload.data() + record.payload.size();
    Require(end <= bytes.data() + bytes.size());
    const std::size_t bodyVertices = std::array<std::size_t, 4>{12, 42, 162, 2562}[record.head.blueprint % 4];
    const std::size_t count = protocol::PatchSize(bodyVertices, record.head.patch);
    protocol::QuantisedPose pose;
    static protocol::ShapeDecoder decoder;
    const protocol::PatchModel model{.rest = std::span(kRest).first(count)};
    if (decoder.Decode(model, record.payload, pose, std::span(shape).first(count)) != protocol::DecodeResult::kOk) {
      continue;
    }
    for (const Vector3& v : std::span(shape).first(count)) {
      const Vector3 shown = protocol::Transform(protocol::Dequantise(pose), v);
      Require(std::isfinite(shown.x) && std::isfinite(shown.y) && std::isfinite(shown.z));
    }
  }
  if (result == protocol::SnapshotResult::kOk && !records.empty()) Require(end == bytes.data() + bytes.size());
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
