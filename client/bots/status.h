// The line that tells how a load test stands while it runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/bots/options.h"
#include "client/bots/runner.h"

namespace wobble::bots {

// With one decimal below ten, "? unit" when there is none.
[[nodiscard]] std::string FormatFigure(std::optional<double> value, const char* unit);
// Seconds up to two minutes, then minutes, then hours.
[[nodiscard]] std::string FormatTime(double seconds);
// duration: of the whole run, seconds; 0: until stopped. Fits 80 columns up to 999 bots.
[[nodiscard]] std::string FormatStatus(const Runner::Progress& progress, const std::vector<Stage>& stages,
                                       double duration, double now);

// Rewritten in place on a terminal, a line each time elsewhere.
class Status {
 public:
  explicit Status(const LoadTestOptions& options);

  // Does nothing while the last one is not old enough. now: seconds since the run began.
  void Show(Runner& runner, double now);
  // Before anything else is written: a line begun on the terminal is ended.
  void Close();

 private:
  std::vector<Stage> m_stages;
  double m_duration;
  bool m_terminal;
  double m_every;
  double m_next;
  bool m_open = false;
};

}  // namespace wobble::bots
