#include "server/encoder.h"

#include <cmath>

#include "protocol/shape_codec.h"
#include "protocol/snapshot.h"

namespace wobble::server {

void Encoder::EncodeBody(const CapturedBody& body, const CapturedBlueprint& blueprint) {
  const std::span<const protocol::Vector3> vertices = body.vertices;
  const std::span<const protocol::Vector3> rest = blueprint.rest;
  const float target = kSnapshotErrorShare * blueprint.size;
  std::size_t first = 0;
  for (std::uint8_t patch = 0; first < vertices.size(); ++patch) {
    const std::size_t count = protocol::PatchSize(vertices.size(), patch);
    m_payload.clear();
    const protocol::ShapeEncoding encoding =
        protocol::EncodeShape(body.pose, rest.subspan(first, count), vertices.subspan(first, count), target,
                              protocol::kMaxRecordPayload, m_payload);
    first += count;
    if (!encoding.fits || encoding.rmsError > target) ++m_coarsened;
    if (!encoding.fits) continue;  // spread over hundreds of metres: left out until it is reset
    const std::size_t begin = m_bytes.size();
    protocol::AppendRecord({body.body, body.blueprint, patch, blueprint.generation}, m_payload, m_bytes);
    m_ranges.push_back({begin, m_bytes.size()});
    m_vertices += count;
    m_bits += 8 * (m_bytes.size() - begin);
    const double share = double{encoding.rmsError} / double{blueprint.size};
    m_errorSquares += share * share * static_cast<double>(count);
  }
}

void Encoder::Encode(std::span<const CapturedBody> bodies, std::span<const CapturedBlueprint> blueprints) {
  m_bytes.clear();
  m_ranges.clear();
  m_bodies.resize(bodies.size());
  std::size_t i = 0;
  for (const CapturedBody& body : bodies) {
    EncodedBody& encoded = m_bodies[i++];
    encoded.body = body.body;
    encoded.centre = body.pose.centroid;
    encoded.records.clear();
    const std::size_t firstRange = m_ranges.size();
    EncodeBody(body, blueprints[body.blueprint]);
    encoded.records.resize(m_ranges.size() - firstRange);
  }
  // m_bytes has stopped growing: only now do spans into it hold.
  auto range = m_ranges.begin();
  for (EncodedBody& encoded : m_bodies) {
    for (auto& record : encoded.records) {
      record = std::span<const std::uint8_t>(m_bytes).subspan(range->begin, range->end - range->begin);
      ++range;
    }
  }
}

double Encoder::BitsPerVertex() const {
  return m_vertices > 0 ? static_cast<double>(m_bits) / static_cast<double>(m_vertices) : 0;
}

double Encoder::ErrorPercentRms() const {
  return m_vertices > 0 ? 100 * std::sqrt(m_errorSquares / static_cast<double>(m_vertices)) : 0;
}

}  // namespace wobble::server
