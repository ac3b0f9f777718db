// Writes the phases of every tick in Chrome's trace format, for chrome://tracing or ui.perfetto.dev.
//
// Format: "Trace Event Format" (Google, 2016), an array of complete events ("ph":"X", microseconds). The closing
// bracket is optional, so a file that was cut off can still be read.
#pragma once

#include <cstdint>
#include <fstream>
#include <span>
#include <string>

#include "server/timing/phases.h"

namespace wobble::ops {

class Trace {
 public:
  // Creates or truncates the file. Returns false when it cannot be written.
  [[nodiscard]] bool Open(const std::string& path);
  // Writes a line for each tick and for each of its phases. lastTick: the world's tick after the last of these.
  // Capture, encode and send alternate within a tick; each is shown as one sum, in this order.
  void Write(std::span<const server::PhaseTimes> ticks, std::uint32_t lastTick);
  // Completes the file. Returns false when anything could not be written, for example to a full disk.
  [[nodiscard]] bool Close();

 private:
  std::ofstream m_file;
  bool m_isFirst = true;
};

}  // namespace wobble::ops
