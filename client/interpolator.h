// One patch of one body over time: the samples that have arrived, and its shape at moments between them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "client/curve.h"
#include "protocol/geometry.h"

namespace wobble::client {

// Seconds after its last sample for which a patch's pose is extrapolated; then it is held where that led.
inline constexpr double kMaxExtrapolation = 0.1;
// A body at rest is taken to begin to move so many seconds before the first sample that shows it moving: the time
// between snapshots.
inline constexpr double kWakeSpan = 1.0 / 30;
// Samples that a track keeps: kMaxDelay at 30 Hz and a few more.
inline constexpr std::size_t kTrackSamples = 24;

struct TrackSample {
  double time = 0;      // world time, seconds
  bool atRest = false;  // from this time on it is at rest, until kWakeSpan before the next sample
  protocol::Pose pose;
  std::vector<protocol::Vector3> shape;  // body frame, metres
};

// A moment as a weighted sum of a track's samples. Weights add up to 1. Valid until the track changes.
struct Moment {
  std::array<const TrackSample*, 4> samples{};  // ascending in time
  std::array<float, 4> poseWeights{};
  std::array<float, 4> shapeWeights{};
  std::size_t count = 0;
  bool held = false;  // the moment is more than kMaxExtrapolation after the last sample
};

class Track {
 public:
  // size: of the body's blueprint, metres. It bounds how far apart two samples may be to count as one motion.
  explicit Track(float size, Curve curve = Curve::kCatmullRom) : m_size(size), m_curve(curve) {}

  // Puts a sample in its place by time. False when there is one of that time already, or it is older than all samples
  // of a full track. Drops samples that no moment from `playback` on needs.
  bool Insert(double time, bool atRest, const protocol::Pose& pose, std::span<const protocol::Vector3> shape,
              double playback);

  [[nodiscard]] bool Empty() const { return m_count == 0; }
  [[nodiscard]] const TrackSample& Newest() const;
  // The track must not be empty. Before its first sample a patch is shown as in that sample.
  [[nodiscard]] Moment FindMoment(double time) const;
  // The centroid of that moment's pose. Not inlined: the code of a curve is large.
  [[nodiscard, gnu::noinline]] protocol::Vector3 FindCentroid(double time) const;

 private:
  [[nodiscard]] static double FindDeparture(const TrackSample& from, const TrackSample& to);
  [[nodiscard]] bool IsCut(const TrackSample& from, const TrackSample& to) const;
  [[nodiscard]] Moment Extrapolate(double time) const;
  [[nodiscard]] Moment Interpolate(std::size_t next, double time) const;
  void DropOldest();

  float m_size;
  Curve m_curve;
  std::vector<TrackSample> m_slots;  // the first m_count ascending in time; the others wait to be used again
  std::size_t m_count = 0;
};

// The pose at a moment.
[[nodiscard]] protocol::Pose BlendPose(const Moment& moment);
// Appends the patch's vertices in the world under `pose`, metres.
void AppendVertices(const Moment& moment, const protocol::Pose& pose, std::vector<protocol::Vector3>& vertices);

}  // namespace wobble::client
