// The last two samples of all bodies, and their copies in the caller's arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/client.h"
#include "client/wobble.h"

namespace wobble::c {

class Frames {
 public:
  // Overwrites the sample before the last.
  void Take(client::Client& client, double now);
  // Of the last sample: writes its counts, and fills the arrays that are not null. False when one is too small; then
  // none is written.
  [[nodiscard]] bool CopyTo(wobble_frame& frame) const;
  // Of the last sample; nullopt when it has no such body.
  [[nodiscard]] std::optional<wobble_body> Find(std::uint32_t index) const;
  // Of a body of the last sample; nullptr when it has no such body.
  [[nodiscard]] const client::Blueprint* FindBlueprint(std::uint32_t body) const;

 private:
  struct Skin {
    std::vector<protocol::Vector3> normals;
    std::uint32_t firstVertex = 0;
    std::uint32_t firstIndex = 0;
    bool changed = true;
  };
  struct Frame {
    std::vector<client::BodySample> samples;
    std::vector<Skin> skins;  // one a sample
    std::uint32_t vertexCount = 0;
    std::uint32_t indexCount = 0;
    std::uint32_t layout = 0;
  };
  [[nodiscard]] const Frame& Newest() const { return m_frames[m_newest]; }

  std::array<Frame, 2> m_frames;
  std::size_t m_newest = 0;
};

}  // namespace wobble::c
