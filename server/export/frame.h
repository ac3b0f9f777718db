// The room server/export writes what a recording holds in the formats of other programs. A walk plays the recording and
// hands frame by frame to the writer of a format.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/play/playground.h"

namespace wobble::exporting {

// The world at one moment of a recording.
struct Frame {
  double time = 0;         // s since the recording began
  std::uint32_t tick = 0;  // of the world
  const server::Playground& ground;
  std::vector<const physics::Body*> bodies;  // the chosen ones that exist, by ascending id
};

class FrameWriter {
 public:
  FrameWriter() = default;
  virtual ~FrameWriter() = default;
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  // Frames come in the order of time. Both return what is wrong, in words that follow the name of the file; empty:
  // nothing.
  [[nodiscard]] virtual std::string Add(const Frame& frame) = 0;
  [[nodiscard]] virtual std::string Finish() = 0;
};

// What of a body can be seen: faces; without any, whole springs, and the vertices at which none ends.
struct Skeleton {
  std::vector<physics::Face> faces;
  std::vector<physics::EdgeEnds> lines;
  std::vector<std::uint16_t> points;

  bool operator==(const Skeleton&) const = default;
};
[[nodiscard]] Skeleton FindSkeleton(const physics::Blueprint& blueprint, const physics::Body& body);

// The name of the player whose body it is; empty: of none.
[[nodiscard]] std::string FindPlayerName(const server::Playground& ground, physics::BodyId body);

// What torn springs of the body there are that its blueprint still has: one a spring, not 0 if torn; empty: none.
[[nodiscard]] const std::vector<std::uint8_t>& ReadTorn(const physics::Body& body);

}  // namespace wobble::exporting
