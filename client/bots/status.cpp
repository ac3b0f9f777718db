// On a terminal the line is cut to the width, because a wrapped line cannot be rewritten in place; the least important
// figures therefore stand last.
#include "client/bots/status.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace wobble::bots {

std::string FormatFigure(std::optional<double> value, const char* unit) {
  if (!value) return std::string("? ") + unit;
  char text[48];
  std::snprintf(text, sizeof text, "%.*f %s", *value < 9.95 ? 1 : 0, *value, unit);
  return text;
}

std::string FormatTime(double seconds) {
  const long whole = std::lround(std::max(0.0, seconds));
  if (whole < 120) return std::to_string(whole) + " s";
  if (whole < 7200) return std::to_string((whole + 30) / 60) + " min";
  return std::to_string((whole + 1800) / 3600) + " h";
}

std::string FormatStatus(const Runner::Progress& progress, const std::vector<Stage>& stages, double duration,
                         double now) {
  const std::size_t stage = FindStageAt(stages, now);
  std::string line = "bots " + std::to_string(progress.playing) + "/" + std::to_string(stages[stage].bots);
  if (stages.size() > 1) line += " stage " + std::to_string(stage + 1) + "/" + std::to_string(stages.size());
  if (duration > 0) {
    const long percent = std::lround(std::floor(100 * std::clamp(now / duration, 0.0, 1.0)));
    line += " " + std::to_string(percent) + "%, " + FormatTime(duration - now) + " left";
  }
  line += ", " + FormatFigure(progress.kbitPerSecondPerBot, "kbit/s each");
  line += ", age " + FormatFigure(progress.snapshotAgeMs, "ms");
  return line + ", late " + FormatFigure(progress.lateMs, "ms");
}

Status::Status(const LoadTestOptions& options)
    : m_stages(ListStages(options)),
      m_duration(FindDuration(options)),
      m_terminal(isatty(STDOUT_FILENO) != 0),
      m_every(options.statusEvery.value_or(m_terminal ? 1.0 : 0.0)),
      m_next(m_every) {}

void Status::Show(Runner& runner, double now) {
  if (m_every <= 0 || now < m_next) return;
  m_next = now + m_every;
  std::string line = FormatStatus(runner.TakeProgress(), m_stages, m_duration, now);
  winsize size{};
  if (m_terminal && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) {
    line.resize(std::min<std::size_t>(line.size(), size.ws_col - 1));
  }
  std::printf(m_terminal ? "\r%s\033[K" : "%s\n", line.c_str());
  std::fflush(stdout);
  m_open = m_terminal;
}

void Status::Close() {
  if (m_open) std::printf("\n");
  std::fflush(stdout);
  m_open = false;
}

}  // namespace wobble::bots
