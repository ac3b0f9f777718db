// Bytes as a body: its pose and deformation. The decoded body must have the error that the encoder reports, and in a
// crowd of three qualities it must have the same bytes as alone.
#include <cmath>

#include "protocol/codec/encoding/crowd_encoder.h"
#include "protocol/codec/shape_codec.h"
#include "tests/fuzz/bases.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

using protocol::Vector3;

// The bytes in order as numbers; zeros past the end.
class Numbers {
 public:
  explicit Numbers(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {}
  std::uint8_t Next() { return m_next < m_bytes.size() ? m_bytes[m_next++] : 0; }
  // −1 … 1, small ones as likely as large.
  float NextShare() {
    const int value = Next() - 128;
    return std::ldexp(static_cast<float>(value), -7 - Next() % 12);
  }
  Vector3 NextVector() {
    const float x = NextShare(), y = NextShare(), z = NextShare();
    return {x, y, z};
  }

 private:
  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
};

void CheckCrowd(const protocol::PatchModel& model, const protocol::Pose& pose, std::span<const Vector3> vertices,
                float target) {
  static protocol::ShapeEncoder encoder;
  static std::array<protocol::CrowdEncoder, 2> crowds{protocol::CrowdEncoder(protocol::KernelSet::kBaseline),
                                                      protocol::CrowdEncoder()};
  constexpr std::size_t kBodies = 3;
  for (protocol::CrowdEncoder& crowd : crowds) {
    std::array<std::vector<std::uint8_t>, kBodies> payloads;
    std::array<protocol::CrowdBody, kBodies> bodies;
    for (std::size_t i = 0; i < kBodies; ++i) {
      bodies[i] = {pose, vertices, std::ldexp(target, static_cast<int>(i)), &payloads[i], {}};
    }
    crowd.Encode(model, 300, bodies);
    for (std::size_t i = 0; i < kBodies; ++i) {
      std::vector<std::uint8_t> alone;
      const auto encoding = encoder.Encode(model, pose, vertices, bodies[i].targetRms, 300, alone);
      Require(payloads[i] == alone && bodies[i].encoding.rmsError == encoding.rmsError);
    }
  }
}

void FuzzOne(std::span<const std::uint8_t> bytes) {
  static const std::array<std::shared_ptr<const protocol::Basis>, 4> kBases = {nullptr, MakeBasis(0, 10),
                                                                               MakeBasis(1, 10), MakeBasis(2, 10)};
  static const auto kObstacles =
      std::vector<protocol::wire::Obstacle>{{protocol::wire::ObstacleKind::Box, {0, 0, -1}, {90, 90, 1}, 0}};
  Numbers numbers(bytes);
  const protocol::Basis* basis = kBases[numbers.Next() % 4].get();
  const float size = std::ldexp(1.0F, numbers.Next() % 12 - 7);
  const float target = size * std::ldexp(1.0F, -static_cast<int>(numbers.Next() % 12));
  protocol::Pose pose;
  pose.centroid = numbers.NextVector() * 64.0F;
  pose.rotation = {numbers.NextShare(), numbers.NextShare(), numbers.NextShare(), numbers.NextShare()};
  std::vector<Vector3> rest, vertices;
  for (int i = 0; i < 10; ++i) {
    rest.push_back(numbers.NextVector() * size);
    vertices.push_back(pose.centroid + rest.back() + numbers.NextVector() * (4 * size));
  }
  static protocol::ShapeEncoder encoder;
  static protocol::ShapeDecoder decoder;
  std::vector<std::uint8_t> payload;
  const protocol::PatchModel model{
      .rest = rest, .size = size, .basis = basis, .obstacles = kObstacles, .reach = protocol::FindReach(rest)};
  const auto encoding = encoder.Encode(model, pose, vertices, target, 300, payload);
  Require(encoding.fits == !payload.empty() && payload.size() <= 300);
  CheckCrowd(model, pose, vertices, target);
  if (!encoding.fits) return;
  std::vector<Vector3> shape(rest.size());
  protocol::QuantisedPose read;
  Require(decoder.Decode(model, payload, read, shape) == protocol::DecodeResult::kOk);
  const protocol::Pose seen = protocol::Dequantise(read);
  double sum = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vector3 error = protocol::Transform(seen, shape[i]) - vertices[i];
    sum += static_cast<double>(protocol::Dot(error, error));
  }
  const double rms = std::sqrt(sum / 10);
  Require(std::fabs(rms - static_cast<double>(encoding.rmsError)) < 1e-4 + 1e-3 * rms);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
