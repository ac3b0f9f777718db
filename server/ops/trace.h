// Per-tick phases in Chrome's trace format, for chrome://tracing or ui.perfetto.dev.
//
// Format: "Trace Event Format" (Google, 2016), an array of complete events ("ph":"X", microseconds). The closing
// bracket may be missing, so a file that was cut off is as good as any.
#pragma once

#include <cstdint>
#include <fstream>
#include <span>
#include <string>

#include "server/timing/phases.h"

namespace wobble::ops {

class Trace {
 public:
  // False when the file cannot be written.
  [[nodiscard]] bool Open(const std::string& path);
  // lastTick: of the world, after the last of these. A line for each tick and for each of its phases. Capturing,
  // encoding and sending alternate within a tick; they are shown added up, one behind the other.
  void Write(std::span<const server::PhaseTimes> ticks, std::uint32_t lastTick);
  // False when something could not be written, as on a disk that is full.
  [[nodiscard]] bool Close();

 private:
  std::ofstream m_file;
  bool m_isFirst = true;
};

}  // namespace wobble::ops
