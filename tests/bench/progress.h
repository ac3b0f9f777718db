// Shows the progress of a report with an estimate of the time left: in a terminal in one line, else a line a minute.
#pragma once

#include <functional>
#include <mutex>
#include <string>

namespace wobble::bench {

class Progress {
 public:
  Progress(std::string report, std::function<bool()> isStopAsked);
  ~Progress();  // takes the line away
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Begins the next part of the report; share: its part of the time of all that are played.
  void Begin(const std::string& part, double share);
  // Shows done of count; may be called from any thread.
  void Show(std::size_t done, std::size_t count);

  [[nodiscard]] bool IsStopAsked() const { return m_isStopAsked(); }

 private:
  std::string m_report;
  std::function<bool()> m_isStopAsked;
  bool m_terminal;
  double m_began;
  std::mutex m_mutex;
  std::string m_part;
  double m_before = 0;  // shares of finished parts
  double m_share = 0;   // of the current part
  double m_shown;       // time of the last output
};

}  // namespace wobble::bench
