#include "server/encoder.h"

#include "protocol/shape_codec.h"
#include "protocol/snapshot.h"

namespace wobble::server {

void Encoder::EncodeBody(float errorShare, const CapturedBody& body, const CapturedBlueprint& blueprint,
                         Encoding& encoding) {
  const std::span<const protocol::Vector3> vertices = body.vertices;
  encoding.body = {};
  encoding.bytes.clear();
  encoding.bytes.reserve((vertices.size() / protocol::kMaxPatchVertices + 1) * protocol::kMaxPacketBytes);
  m_ends.clear();
  const std::span<const protocol::Vector3> rest = blueprint.rest;
  const float target = errorShare * blueprint.size;
  std::size_t first = 0;
  for (std::uint8_t patch = 0; first < vertices.size(); ++patch) {
    const std::size_t count = protocol::PatchSize(vertices.size(), patch);
    m_payload.clear();
    const protocol::PatchModel model{rest.subspan(first, count), blueprint.size,
                                     blueprint.bases.empty() ? nullptr : blueprint.bases[patch].get(), m_obstacles};
    const protocol::ShapeEncoding shape = m_shapes.Encode(model, body.pose, vertices.subspan(first, count), target,
                                                          protocol::kMaxRecordPayload, m_payload);
    first += count;
    if (!shape.fits || shape.rmsError > target) ++m_coarsened;
    if (!shape.fits) continue;  // spread over hundreds of metres: left out until it is reset
    protocol::AppendRecord({body.body, body.blueprint, patch, blueprint.generation, body.restTick}, m_payload,
                           encoding.bytes);
    m_ends.push_back(encoding.bytes.size());
    const double share = double{shape.rmsError} / double{blueprint.size};
    encoding.body.vertices += static_cast<std::uint32_t>(count);
    encoding.body.errorSquares += share * share * static_cast<double>(count);
  }
  const double vertexCount = std::max(1U, encoding.body.vertices);
  encoding.body.error = std::sqrt(encoding.body.errorSquares / vertexCount);
  // The bytes have stopped growing: only now do spans into them hold.
  encoding.records.clear();
  for (std::size_t begin = 0; const std::size_t end : m_ends) {
    encoding.records.push_back(std::span<const std::uint8_t>(encoding.bytes).subspan(begin, end - begin));
    begin = end;
  }
  encoding.body.records = encoding.records;
}

void Encoder::Follow(std::span<const ShownBody> bodies) { FollowBodies(bodies, m_bodies); }

const EncodedBody& Encoder::Encode(std::size_t index, std::size_t quality, const CapturedBody& body,
                                   const CapturedBlueprint& blueprint) {
  Encoding& encoding = m_bodies[index].qualities[quality];
  if (encoding.version != body.version) {
    encoding.version = body.version;
    EncodeBody(kSnapshotErrorShares[quality], body, blueprint, encoding);
  }
  return encoding.body;
}

}  // namespace wobble::server
