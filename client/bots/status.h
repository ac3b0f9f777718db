// The status line of a running load test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/bots/options.h"
#include "client/bots/runner.h"

namespace wobble::bots {

// "12 unit", with one decimal below ten; "? unit" for nullopt.
[[nodiscard]] std::string FormatFigure(std::optional<double> value, const char* unit);
// Formats a time: in seconds up to two minutes, in minutes up to two hours, then in hours.
[[nodiscard]] std::string FormatTime(double seconds);
// duration: of the whole run, seconds; 0: until stopped. The line fits 80 columns up to 999 bots.
[[nodiscard]] std::string FormatStatus(const Runner::Progress& progress, const std::vector<Stage>& stages,
                                       double duration, double now);

// Prints the status line: rewritten in place on a terminal, one line per print elsewhere.
class Status {
 public:
  explicit Status(const LoadTestOptions& options);

  // Prints when the previous line is old enough. now: seconds since the run began.
  void Show(Runner& runner, double now);
  // Ends a line begun on the terminal. Must precede any other output.
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
