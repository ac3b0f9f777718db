// Catmull-Rom over uneven times, as weights of four samples.
//
// Samples are unevenly spaced: packets get lost, and the budget sends some bodies less often. Each segment is a cubic
// Hermite whose tangents are those of the parabola through a sample and its two neighbours (three-point differences for
// uneven spacing; with even spacing this is the classic Catmull-Rom spline), so motion under constant acceleration is
// reproduced exactly. At an end of the track the parabola through the nearest three samples is used, with two samples a
// line.
//
// The curve is linear in the samples, so its four weights are found once and applied to centroid, quaternion and every
// vertex. Quaternions are brought into one hemisphere before and normalised after; over a thirtieth of a second that
// differs from a spherical curve by less than the rounding on the wire.
//
// Only the pose is extrapolated. A shape's vibration decorrelates in about 50 ms, so extrapolating its last velocity is
// worse than keeping the shape; for the same reason shapes take no tangents across a long gap.
#include "client/interpolator.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::client {
namespace {

using protocol::Pose;
using protocol::Quaternion;
using protocol::Vector3;

// Between two samples a body moves at most at this speed, m/s, plus kCutSizes times its size; else it has respawned.
constexpr double kMaxSpeed = 20.0;
constexpr double kCutSizes = 2.0;
// The longest segment over which a shape follows a curve, seconds: three times its decorrelation time.
constexpr double kMaxShapeCurve = 0.15;

using Weights = std::array<double, 4>;

// Weights of h1 × the tangent at the start of the middle segment; h1 is its length, h0 that of the segment before.
Weights StartTangent(double h0, double h1) {
  const double a = h1 * h1 / (h0 * (h0 + h1));
  const double b = h0 / (h0 + h1);
  return {-a, a - b, b, 0};
}

// The same at its end; h2 is the length of the segment after.
Weights EndTangent(double h1, double h2) {
  const double a = h2 / (h1 + h2);
  const double b = h1 * h1 / (h2 * (h1 + h2));
  return {0, -a, a - b, b};
}

// The other end's tangent of a parabola: twice the chord minus this one.
Weights MirrorTangent(const Weights& tangent) {
  Weights mirrored{0, -2, 2, 0};
  for (std::size_t i = 0; i < 4; ++i) mirrored[i] -= tangent[i];
  return mirrored;
}

// Weights of p0..p3 at p1 + u (p2 - p1), u in [0, 1]; h0 or h2 is 0 where that neighbour is missing.
Weights CurveWeights(double h0, double h1, double h2, double u) {
  Weights start{0, -1, 1, 0};
  Weights end = start;
  if (h0 > 0) start = StartTangent(h0, h1);
  if (h2 > 0) end = EndTangent(h1, h2);
  if (h0 > 0 && h2 <= 0) end = MirrorTangent(start);
  if (h2 > 0 && h0 <= 0) start = MirrorTangent(end);

  const double v = 1 - u;
  const double p2 = u * u * (3 - 2 * u);
  Weights weights{0, 1 - p2, p2, 0};
  for (std::size_t i = 0; i < 4; ++i) weights[i] += u * v * v * start[i] - u * u * v * end[i];
  return weights;
}

float Dot(Quaternion a, Quaternion b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

Quaternion Normalise(Quaternion q, Quaternion otherwise) {
  const float length = std::sqrt(Dot(q, q));
  if (!(length > 1e-3F)) return otherwise;
  const float s = 1.0F / length;
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}

Moment Still(const TrackSample& sample) {
  Moment moment;
  moment.samples[0] = &sample;
  moment.poseWeights[0] = moment.shapeWeights[0] = 1;
  moment.count = 1;
  return moment;
}

}  // namespace

const TrackSample& Track::Newest() const {
  assert(m_count > 0);
  return m_slots[m_count - 1];
}

bool Track::Insert(double time, bool atRest, const Pose& pose, std::span<const Vector3> shape, double playback) {
  // Keeps the segment that is shown and one sample before it for the tangent.
  while (m_count > 2 && m_slots[2].time <= playback) DropOldest();
  std::size_t place = m_count;
  while (place > 0 && m_slots[place - 1].time >= time) --place;
  if (place < m_count && m_slots[place].time == time) return false;
  if (m_count == kTrackSamples) {
    if (place == 0) return false;
    DropOldest();
    --place;
  }

  if (m_slots.size() == m_count) m_slots.emplace_back();
  TrackSample& slot = m_slots[m_count];
  slot.time = time;
  slot.atRest = atRest;
  slot.pose = pose;
  slot.shape.assign(shape.begin(), shape.end());
  ++m_count;
  const auto begin = m_slots.begin();
  std::rotate(begin + static_cast<std::ptrdiff_t>(place), begin + static_cast<std::ptrdiff_t>(m_count - 1),
              begin + static_cast<std::ptrdiff_t>(m_count));
  return true;
}

void Track::DropOldest() {
  std::rotate(m_slots.begin(), m_slots.begin() + 1, m_slots.begin() + static_cast<std::ptrdiff_t>(m_count));
  --m_count;
}

// The time at which a patch leaves sample `from` for `to`, the sample after it.
double Track::FindDeparture(const TrackSample& from, const TrackSample& to) {
  return from.atRest ? std::max(from.time, to.time - kWakeSpan) : from.time;
}

bool Track::IsCut(const TrackSample& from, const TrackSample& to) const {
  const double distance = protocol::Length(to.pose.centroid - from.pose.centroid);
  return distance > kMaxSpeed * (to.time - from.time) + kCutSizes * static_cast<double>(m_size);
}

Moment Track::FindMoment(double time) const {
  assert(m_count > 0);
  if (time >= m_slots[m_count - 1].time) return Extrapolate(time);
  std::size_t next = 0;
  while (m_slots[next].time <= time) ++next;
  return next == 0 ? Still(m_slots[0]) : Interpolate(next, time);
}

Vector3 Track::FindCentroid(double time) const { return BlendPose(FindMoment(time)).centroid; }

Moment Track::Extrapolate(double time) const {
  const TrackSample& last = m_slots[m_count - 1];
  const double beyond = time - last.time;
  Moment moment = Still(last);
  if (last.atRest) return moment;
  if (m_count > 1 && !IsCut(m_slots[m_count - 2], last)) {
    const TrackSample& before = m_slots[m_count - 2];
    const double span = last.time - FindDeparture(before, last);
    const auto s = static_cast<float>(std::min(beyond, kMaxExtrapolation) / span);
    moment = {.samples = {&before, &last}, .poseWeights = {-s, 1 + s}, .shapeWeights = {0, 1}, .count = 2};
  }
  moment.held = beyond > kMaxExtrapolation;
  return moment;
}

Moment Track::Interpolate(std::size_t next, double time) const {
  const TrackSample& from = m_slots[next - 1];
  const TrackSample& to = m_slots[next];
  const double departure = FindDeparture(from, to);
  if (time < departure || IsCut(from, to)) return Still(from);
  const bool isCurve = m_curve == Curve::kCatmullRom;
  const bool hasBefore = isCurve && !from.atRest && next >= 2;
  const TrackSample* before = hasBefore && !IsCut(m_slots[next - 2], from) ? &m_slots[next - 2] : nullptr;
  const bool hasAfter = isCurve && next + 1 < m_count;
  const TrackSample* after = hasAfter && !IsCut(to, m_slots[next + 1]) ? &m_slots[next + 1] : nullptr;

  const double h = to.time - departure;
  const double u = (time - departure) / h;
  const Weights curve = CurveWeights(before != nullptr ? from.time - FindDeparture(*before, from) : 0, h,
                                     after != nullptr ? after->time - FindDeparture(to, *after) : 0, u);
  const Weights line{0, 1 - u, u, 0};
  const Weights& shape = h > kMaxShapeCurve ? line : curve;

  Moment moment;
  const std::array<const TrackSample*, 4> samples{before, &from, &to, after};
  for (std::size_t i = 0; i < 4; ++i) {
    if (samples[i] == nullptr) continue;
    moment.samples[moment.count] = samples[i];
    moment.poseWeights[moment.count] = static_cast<float>(curve[i]);
    moment.shapeWeights[moment.count] = static_cast<float>(shape[i]);
    ++moment.count;
  }
  return moment;
}

Pose BlendPose(const Moment& moment) {
  // Centroids are summed relative to one of them: far from the origin the sum would round to millimetres.
  const Pose& base = moment.samples[0]->pose;
  Vector3 offset;
  Quaternion sum{0, 0, 0, 0};
  Quaternion previous = base.rotation;
  for (std::size_t i = 0; i < moment.count; ++i) {
    const Pose& pose = moment.samples[i]->pose;
    const float weight = moment.poseWeights[i];
    offset = offset + (pose.centroid - base.centroid) * weight;
    Quaternion q = pose.rotation;
    if (Dot(q, previous) < 0) q = {-q.w, -q.x, -q.y, -q.z};
    previous = q;
    sum = {sum.w + q.w * weight, sum.x + q.x * weight, sum.y + q.y * weight, sum.z + q.z * weight};
  }
  return {base.centroid + offset, Normalise(sum, previous)};
}

void AppendVertices(const Moment& moment, const Pose& pose, std::vector<Vector3>& vertices) {
  const std::size_t count = moment.samples[0]->shape.size();
  for (std::size_t i = 0; i < count; ++i) {
    Vector3 point;
    for (std::size_t j = 0; j < moment.count; ++j) {
      point = point + moment.samples[j]->shape[i] * moment.shapeWeights[j];
    }
    vertices.push_back(protocol::Transform(pose, point));
  }
}

}  // namespace wobble::client
