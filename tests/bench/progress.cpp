#include "tests/bench/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "client/command/clock.h"

namespace wobble::bench {
namespace {

// s; in a log a line each time, and none for a run of less than a minute.
constexpr double kShowEvery = 0.2;
constexpr double kShowEveryInLog = 60;
// Below this share of the work, an estimate of the time left is meaningless.
constexpr double kLeastShare = 0.02;

}  // namespace

Progress::Progress(std::string report, std::function<bool()> isStopAsked)
    : m_report(std::move(report)),
      m_isStopAsked(std::move(isStopAsked)),
      m_terminal(isatty(STDERR_FILENO) != 0),
      m_began(command::ReadClock()),
      m_shown(m_began) {}

Progress::~Progress() {
  if (m_terminal) std::fprintf(stderr, "\r\033[K");
}

void Progress::Begin(const std::string& part, double share) {
  const std::lock_guard lock(m_mutex);
  m_part = part;
  m_before += m_share;
  m_share = share;
}

void Progress::Show(std::size_t done, std::size_t count) {
  const std::lock_guard lock(m_mutex);
  const double now = command::ReadClock();
  if (now < m_shown + (m_terminal ? kShowEvery : kShowEveryInLog)) return;
  m_shown = now;
  const double share = m_before + m_share * static_cast<double>(done) / static_cast<double>(count);
  std::fprintf(stderr, "%s%s: %s %zu/%zu", m_terminal ? "\r" : "", m_report.c_str(), m_part.c_str(), done, count);
  if (share > kLeastShare) std::fprintf(stderr, ", %ld s left", std::lround((now - m_began) * (1 / share - 1)));
  std::fputs(m_terminal ? "\033[K" : "\n", stderr);
  std::fflush(stderr);
}

}  // namespace wobble::bench
