// The frames of input that go to the server, and when each first went.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "client/client.h"

namespace wobble::client {

class InputStream {
 public:
  // Makes the frame of this moment. estimatedTick: the server's, as far as it is known. None is made, and the last ones
  // stay, when its stamp would be ahead of that.
  void Add(const Input& input, double estimatedTick, double now);

  // Newest first, at most kInputRedundancy, stamps strictly descending. Not empty once Add was called.
  [[nodiscard]] std::span<const wire::InputFrame> Frames() const { return std::span(m_frames).first(m_count); }

  // A snapshot says that the world has used the frame of inputTick. Seconds since that was first sent, if it is newer
  // than any heard of before; otherwise, and for what was never sent or long ago, -1.
  double MeasureEcho(std::uint32_t inputTick, double now);

 private:
  // Frames whose moment is remembered: at 60 Hz as many as an answer may take until the server counts as silent.
  static constexpr std::size_t kRemembered = 512;
  struct SentFrame {
    std::uint32_t tick = 0;  // 0: none, stamps begin at 1
    double sentAt = 0;
  };

  std::array<wire::InputFrame, protocol::kInputRedundancy> m_frames;
  std::size_t m_count = 0;
  std::array<SentFrame, kRemembered> m_sent{};
  std::uint32_t m_echoed = 0;  // newest
};

}  // namespace wobble::client
