// One patch of one body over time: the samples that have arrived, and where it was in between.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "client/curve.h"
#include "protocol/geometry.h"

namespace wobble::client {

// Seconds. Beyond its last sample a patch goes on as it was going for the first, then it is held where that led.
inline constexpr double kMaxExtrapolation = 0.1;
// What has lain still until it was seen to move began to do so about so long before, seconds: snapshots come that
// often.
inline constexpr double kWakeSpan = 1.0 / 30;
// Samples a track keeps: kMaxDelay at 30 Hz and a few more.
inline constexpr std::size_t kTrackSamples = 24;

struct TrackSample {
  double time = 0;      // world time, seconds
  bool atRest = false;  // from then on it lies still, until shortly before the next sample
  protocol::Pose pose;
  std::vector<protocol::Vector3> shape;  // body frame, metres
};

// A moment as a weighted sum of a track's samples; weights add up to one. Valid until the track changes.
struct Moment {
  std::array<const TrackSample*, 4> samples{};  // ascending in time
  std::array<float, 4> poseWeights{};
  std::array<float, 4> shapeWeights{};
  std::size_t count = 0;
  bool held = false;  // the moment is more than kMaxExtrapolation after the last sample
};

class Track {
 public:
  // size: RMS radius of the body, metres; it sets how far a sample may be from the one before and still be motion.
  explicit Track(float size, Curve curve = Curve::kCatmullRom) : m_size(size), m_curve(curve) {}

  // Puts a sample in its place; false when one of that time is there, or it is older than all of a full track. What
  // lies so far before `playback` that no moment from there on needs it makes room.
  bool Insert(double time, bool atRest, const protocol::Pose& pose, std::span<const protocol::Vector3> shape,
              double playback);

  [[nodiscard]] bool Empty() const { return m_count == 0; }
  [[nodiscard]] const TrackSample& Newest() const;
  // Not empty. Before its first sample a patch is shown as in that.
  [[nodiscard]] Moment FindMoment(double time) const;

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

[[nodiscard]] protocol::Pose BlendPose(const Moment& moment);
// Appends the patch's vertices in the world under `pose`, metres.
void AppendVertices(const Moment& moment, const protocol::Pose& pose, std::vector<protocol::Vector3>& vertices);

}  // namespace wobble::client
