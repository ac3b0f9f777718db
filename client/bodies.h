// All known bodies: their tracks, and how they look at a moment.
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

// Seconds of world time without a record after which a moving body is dropped, as removed or out of view. The server
// reliably announces removals; this is a fallback, and long enough for the last body of a crowd to have its turn. A
// body at rest gets no more records and stays.
inline constexpr double kForgetAfter = 30.0;
// Vertices that all tracks may hold together, kTrackCost more for each track: 5,000 balls of 92 vertices. Each vertex
// is kept up to kTrackSamples times, at 12 bytes: 150 MB at worst.
inline constexpr std::size_t kMaxTrackedVertices = std::size_t{1} << 19;
inline constexpr std::size_t kTrackCost = 8;
// Blueprints that a body may change to within the delay at which it is shown: kMaxDelay at 30 Hz and one more.
inline constexpr std::size_t kMaxForms = 16;

class Bodies {
 public:
  explicit Bodies(Curve curve = Curve::kCatmullRom) : m_curve(curve) {}

  // Adds a decoded record. time: of its tick, or since when the body is at rest. shape: as many vertices as that patch
  // of the blueprint has. False when there would be too many bodies or vertices. A record that is too old, or of a body
  // that has been removed since, is ignored and gives true.
  [[nodiscard]] bool Add(const protocol::RecordHead& head, const std::shared_ptr<const Blueprint>& blueprint,
                         std::uint32_t tick, double time, const protocol::Pose& pose,
                         std::span<const protocol::Vector3> shape, double playback);

  // The server has removed the body at this tick: late records of earlier ticks do not bring it back.
  void Remove(std::uint32_t body, std::uint32_t tick);
  // Drops all bodies that are not at rest and whose newest sample is older than this, world seconds.
  void Forget(double olderThan);

  // All bodies at `time`, by ascending number. newest: time of the newest tick known, for their age. Counts frames and
  // stalls in the statistics.
  void Sample(double time, double newest, Detail detail, std::vector<BodySample>& samples, Statistics& statistics);
  [[nodiscard]] std::size_t Count() const { return m_bodies.size(); }
  // The first patch of the body as it is shown at `time`; nullptr where nothing is. Valid until a record comes.
  [[nodiscard]] const Track* FindTrack(std::uint32_t body, double time) const;

 private:
  // A body with one blueprint, from its first record on. Successive forms with the same rest shape share their tracks.
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

  // The form that a record of this blueprint and tick belongs to; nullptr when it comes too late.
  static Form* FindForm(Body& body, const Blueprint& blueprint, std::uint32_t tick);
  // False when there would be too many vertices.
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
  std::array<Removal, 64> m_removals{};  // the latest: no record is later than these reach back
  std::size_t m_nextRemoval = 0;
};

}  // namespace wobble::client
