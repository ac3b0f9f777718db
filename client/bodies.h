// All bodies that have been heard of: their tracks, and how they look at a moment.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "client/client.h"
#include "client/interpolator.h"
#include "client/statistics.h"
#include "protocol/snapshot.h"

namespace wobble::client {

// Seconds of world time after which a body that moved when it was last heard of is taken to be gone, or out of view.
// The server says reliably when a body goes; this is for the case that it does not, and long enough for the last in a
// crowd to have its turn. Of a body that lies still nothing comes any more, and it stays.
inline constexpr double kForgetAfter = 30.0;
// What all tracks may hold together, vertices, each track counting kTrackCost more for its frame: 5,000 balls of
// 92 vertices. Each is kept up to kTrackSamples times, at 12 bytes: 150 MB at the very worst.
inline constexpr std::size_t kMaxTrackedVertices = std::size_t{1} << 19;
inline constexpr std::size_t kTrackCost = 8;
// Blueprints that a body may go through within the delay at which it is shown: kMaxDelay at 30 Hz and one more.
inline constexpr std::size_t kMaxForms = 16;

class Bodies {
 public:
  explicit Bodies(Curve curve = Curve::kCatmullRom) : m_curve(curve) {}

  // A decoded record. time: of its tick, or since when the body lies still. shape has as many vertices as that patch of
  // the blueprint. False when it would be one body or vertex too many; what is old, or of a body that has been removed
  // since, is ignored and true.
  [[nodiscard]] bool Add(const protocol::RecordHead& head, const std::shared_ptr<const Blueprint>& blueprint,
                         std::uint32_t tick, double time, const protocol::Pose& pose,
                         std::span<const protocol::Vector3> shape, double playback);

  // The server removed it at this tick: records of earlier ticks that still come do not bring it back.
  void Remove(std::uint32_t body, std::uint32_t tick);
  // Drops all bodies that do not lie still and whose newest sample is older than this, world seconds.
  void Forget(double olderThan);

  // All bodies at `time`, by ascending number. newest: time of the newest tick known. Counts what it shows.
  void Sample(double time, double newest, Detail detail, std::vector<BodySample>& samples, Statistics& statistics);
  [[nodiscard]] std::size_t Count() const { return m_bodies.size(); }

 private:
  // A body under one blueprint, from its first record on. Where the rest shape stays the same, so do the tracks.
  struct Form {
    std::shared_ptr<const Blueprint> blueprint;
    std::shared_ptr<std::vector<Track>> patches;
    std::uint32_t firstTick = 0;
    double firstTime = 0;
  };
  struct Body {
    std::vector<Form> forms;  // ascending by time, at least one
    std::uint32_t newestTick = 0;
    double newestTime = 0;
    bool rests = false;  // in the newest record
    bool wasHeld = false;
  };
  struct Removal {
    std::uint32_t body = 0;  // 0: none
    std::uint32_t tick = 0;
  };
  using BodyMap = std::map<std::uint32_t, Body>;

  // Where a record of this blueprint and tick belongs; nullptr when it comes too late to be of use.
  static Form* FindForm(Body& body, const Blueprint& blueprint, std::uint32_t tick);
  // False when it would be too much.
  bool AppendForm(Body& body, const std::shared_ptr<const Blueprint>& blueprint);
  void DropOldestForm(Body& body);
  void DropUnseen(Body& body, double playback);
  [[nodiscard]] bool WasRemoved(std::uint32_t body, std::uint32_t tick) const;
  BodyMap::iterator Erase(BodyMap::iterator body);
  static const Form& ChooseForm(const Body& body, double time);
  static void SampleBody(const Form& form, double time, double newest, Detail detail, BodySample& sample);

  Curve m_curve;
  BodyMap m_bodies;
  std::size_t m_tracked = 0;             // counted against kMaxTrackedVertices
  std::array<Removal, 64> m_removals{};  // the latest; a late record is late by less than these took
  std::size_t m_nextRemoval = 0;
};

}  // namespace wobble::client
