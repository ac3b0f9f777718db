// The frames of input that go to the server, and when each was first sent.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "client/client.h"

namespace wobble::client {

// An axis of an input, -1 to 1, as it is sent: times 127.
[[nodiscard]] std::int8_t RoundAxis(float value);

class InputStream {
 public:
  // Makes the frame of this moment. estimatedTick: of the server. No frame is made, and the last ones stay, when its
  // stamp would be too far ahead of that.
  void Add(const Input& input, double estimatedTick, double now);

  // The frames to send: newest first, at most kInputRedundancy, stamps strictly descending. Not empty after an Add.
  [[nodiscard]] std::span<const wire::InputFrame> Frames() const { return std::span(m_frames).first(m_count); }

  // A snapshot says that the world has used the frame with the stamp inputTick. Returns the seconds since that frame
  // was first sent, or -1 when an equal or newer stamp came before, or the frame was never sent or is forgotten.
  double MeasureEcho(std::uint32_t inputTick, double now);

 private:
  // Frames whose time of sending is remembered: at 60 Hz enough for the silence after which a server counts as gone.
  static constexpr std::size_t kRemembered = 512;
  struct SentFrame {
    std::uint32_t tick = 0;  // 0: none, stamps begin at 1
    double sentAt = 0;
  };

  std::array<wire::InputFrame, protocol::kInputRedundancy> m_frames;
  std::size_t m_count = 0;
  std::array<SentFrame, kRemembered> m_sent{};
  std::uint32_t m_echoed = 0;  // the newest stamp that a snapshot has named
};

}  // namespace wobble::client
