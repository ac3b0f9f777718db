#include "server/encoder.h"

#include <cmath>

#include "protocol/shape_codec.h"
#include "protocol/snapshot.h"

namespace wobble::server {

void Encoder::EncodeBody(const CapturedBody& body, const CapturedBlueprint& blueprint, EncodedBody& encoded) {
  const std::span<const protocol::Vector3> vertices = body.vertices;
  encoded.bytes.clear();
  encoded.bytes.reserve((vertices.size() / protocol::kMaxPatchVertices + 1) * protocol::kMaxPacketBytes);
  m_ends.clear();
  const std::span<const protocol::Vector3> rest = blueprint.rest;
  const float target = kSnapshotErrorShare * blueprint.size;
  std::size_t first = 0;
  for (std::uint8_t patch = 0; first < vertices.size(); ++patch) {
    const std::size_t count = protocol::PatchSize(vertices.size(), patch);
    m_payload.clear();
    const protocol::PatchModel model{rest.subspan(first, count), blueprint.size,
                                     blueprint.bases.empty() ? nullptr : blueprint.bases[patch].get(), m_obstacles};
    const protocol::ShapeEncoding encoding = m_shapes.Encode(model, body.pose, vertices.subspan(first, count), target,
                                                             protocol::kMaxRecordPayload, m_payload);
    first += count;
    if (!encoding.fits || encoding.rmsError > target) ++m_coarsened;
    if (!encoding.fits) continue;  // spread over hundreds of metres: left out until it is reset
    const std::size_t begin = encoded.bytes.size();
    protocol::AppendRecord({body.body, body.blueprint, patch, blueprint.generation}, m_payload, encoded.bytes);
    m_ends.push_back(encoded.bytes.size());
    m_vertices += count;
    m_bits += 8 * (encoded.bytes.size() - begin);
    const double share = double{encoding.rmsError} / double{blueprint.size};
    m_errorSquares += share * share * static_cast<double>(count);
  }
  // The bytes have stopped growing: only now do spans into them hold.
  encoded.records.clear();
  for (std::size_t begin = 0; const std::size_t end : m_ends) {
    encoded.records.push_back(std::span<const std::uint8_t>(encoded.bytes).subspan(begin, end - begin));
    begin = end;
  }
}

void Encoder::Follow(std::span<const ShownBody> bodies) { FollowBodies(bodies, m_bodies); }

Records Encoder::Encode(std::size_t index, const CapturedBody& body, const CapturedBlueprint& blueprint) {
  EncodedBody& encoded = m_bodies[index];
  if (encoded.version != body.version) {
    encoded.version = body.version;
    EncodeBody(body, blueprint, encoded);
  }
  return encoded.records;
}

double Encoder::BitsPerVertex() const {
  return m_vertices > 0 ? static_cast<double>(m_bits) / static_cast<double>(m_vertices) : 0;
}

double Encoder::ErrorPercentRms() const {
  return m_vertices > 0 ? 100 * std::sqrt(m_errorSquares / static_cast<double>(m_vertices)) : 0;
}

}  // namespace wobble::server
