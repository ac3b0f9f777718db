// Each thread has an encoder with working memory of its own. Records are kept per body and quality with the version of
// the capture that they were made from, so a body that several clients take, or that has not moved, is encoded once.
#include "server/snapshots/encoder.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <utility>

#include "protocol/codec/encoding/shape_encoder.h"
#include "protocol/snapshot.h"
#include "server/physics/model/parallel.h"

namespace wobble::server {

// The encoder of one thread; reuses its memory from body to body.
class Encoder::BodyEncoder {
 public:
  explicit BodyEncoder(std::span<const protocol::wire::Obstacle> obstacles) : m_obstacles(obstacles) {}

  void Encode(float errorShare, const CapturedBody& body, const CapturedBlueprint& blueprint, Encoding& encoding);

  [[nodiscard]] std::uint64_t CoarsenedRecords() const { return m_coarsened; }

 private:
  std::span<const protocol::wire::Obstacle> m_obstacles;
  protocol::ShapeEncoder m_shapes;
  std::vector<std::size_t> m_ends;  // where each record ends in the bytes
  std::vector<std::uint8_t> m_payload;
  std::uint64_t m_coarsened = 0;
};

void Encoder::BodyEncoder::Encode(float errorShare, const CapturedBody& body, const CapturedBlueprint& blueprint,
                                  Encoding& encoding) {
  const std::span<const protocol::Vector3> vertices = body.vertices;
  encoding.version = body.version;
  encoding.body = {};
  encoding.bytes.clear();
  encoding.bytes.reserve((vertices.size() / protocol::kMaxPatchVertices + 1) * protocol::kMaxPacketBytes);
  m_ends.clear();
  const float target = errorShare * blueprint.size;
  std::size_t first = 0;
  for (std::uint8_t patch = 0; first < vertices.size(); ++patch) {
    const std::size_t count = protocol::PatchSize(vertices.size(), patch);
    m_payload.clear();
    const protocol::PatchModel model =
        protocol::MakePatchModel(blueprint.rest, blueprint.size, blueprint.patches, patch, m_obstacles);
    const protocol::ShapeEncoding shape = m_shapes.Encode(model, body.pose, vertices.subspan(first, count), target,
                                                          protocol::kMaxRecordPayload, m_payload);
    first += count;
    if (!shape.fits || shape.rmsError > target) ++m_coarsened;
    if (!shape.fits) continue;  // spread over hundreds of metres: left out until the body is reset
    protocol::AppendRecord({.body = body.body,
                            .blueprint = body.blueprint,
                            .patch = patch,
                            .generation = blueprint.generation,
                            .restTick = body.restTick},
                           m_payload, encoding.bytes);
    m_ends.push_back(encoding.bytes.size());
    const double share = double{shape.rmsError} / double{blueprint.size};
    encoding.body.vertices += static_cast<std::uint32_t>(count);
    encoding.body.errorSquares += share * share * static_cast<double>(count);
  }
  const double vertexCount = std::max(1U, encoding.body.vertices);
  encoding.body.error = std::sqrt(encoding.body.errorSquares / vertexCount);
  // Spans into the bytes are valid only now that the bytes no longer grow.
  encoding.records.clear();
  for (std::size_t begin = 0; const std::size_t end : m_ends) {
    encoding.records.push_back(std::span<const std::uint8_t>(encoding.bytes).subspan(begin, end - begin));
    begin = end;
  }
  encoding.body.records = encoding.records;
}

struct Encoder::Workers {
  Workers(std::span<const protocol::wire::Obstacle> obstacles, int count)
      : threads(count), encoders([obstacles] { return BodyEncoder(obstacles); }) {}

  physics::Threads threads;
  tbb::enumerable_thread_specific<BodyEncoder> encoders;
};

Encoder::Encoder(std::vector<protocol::wire::Obstacle> obstacles, int threads)
    : m_obstacles(std::move(obstacles)), m_workers(std::make_unique<Workers>(m_obstacles, threads)) {}
Encoder::~Encoder() = default;

void Encoder::Follow(std::span<const ShownBody> bodies, std::uint32_t tick) {
  FollowBodies(bodies, m_bodies);
  m_tick = tick;
}

const EncodedBody& Encoder::NoteRead(Encoding& encoding) const {
  if (encoding.lastRead != m_tick) encoding.readBefore = std::exchange(encoding.lastRead, m_tick);
  return encoding.body;
}

const EncodedBody& Encoder::Encode(std::size_t index, std::size_t quality, const CapturedBody& body,
                                   const CapturedBlueprint& blueprint) {
  Encoding& encoding = m_bodies[index].qualities[quality];
  if (encoding.version != body.version) {
    m_workers->encoders.local().Encode(kSnapshotErrorShares[quality], body, blueprint, encoding);
  }
  return NoteRead(encoding);
}

const EncodedBody* Encoder::Find(std::size_t index, std::size_t quality, std::uint64_t version) {
  Encoding& encoding = m_bodies[index].qualities[quality];
  return version != 0 && encoding.version == version ? &NoteRead(encoding) : nullptr;
}

bool Encoder::IsExpected(std::size_t index) const {
  return std::ranges::any_of(m_bodies[index].qualities, [this](const Encoding& each) { return IsExpected(each); });
}

void Encoder::EncodeAhead(std::span<const FreshCapture> captures) {
  m_workers->threads.ForEach(captures.size() * kQualities, [&](std::size_t i) {
    const FreshCapture& fresh = captures[i / kQualities];
    const std::size_t quality = i % kQualities;
    Encoding& encoding = m_bodies[fresh.index].qualities[quality];
    if (!IsExpected(encoding) || encoding.version == fresh.body->version) return;
    m_workers->encoders.local().Encode(kSnapshotErrorShares[quality], *fresh.body, *fresh.blueprint, encoding);
  });
}

std::uint64_t Encoder::CoarsenedRecords() const {
  std::uint64_t sum = 0;
  for (const BodyEncoder& each : m_workers->encoders) sum += each.CoarsenedRecords();
  return sum;
}

}  // namespace wobble::server
