// How far a report has come, on a terminal with an estimate of the time left; elsewhere silent.
#pragma once

#include <functional>
#include <mutex>
#include <string>

namespace wobble::bench {

class Progress {
 public:
  // shares: what all parts together add up to, in any unit that their times go by.
  Progress(std::string report, double shares, std::function<bool()> isStopAsked);
  ~Progress();  // takes the line away
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // The next part of the report begins, this one's share of the whole.
  void Begin(const std::string& part, double share);
  // From any thread.
  void Show(std::size_t done, std::size_t count);

  [[nodiscard]] bool IsStopAsked() const { return m_isStopAsked(); }

 private:
  std::string m_report;
  double m_shares;
  std::function<bool()> m_isStopAsked;
  bool m_terminal;
  double m_began;
  std::mutex m_mutex;
  std::string m_part;
  double m_before = 0;  // shares of the parts that are done
  double m_share = 0;   // of this one
  double m_shown = 0;   // when
};

}  // namespace wobble::bench
