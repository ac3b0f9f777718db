// Notices that files have been written anew, so that they can be read again.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace wobble::gateway {

class WatchedFiles {
 public:
  // Those that are there count as known.
  explicit WatchedFiles(std::vector<std::string> paths) : m_paths(std::move(paths)), m_times(ReadTimes()) {}

  // Whether any has been written, put in another's place or removed since the call before; looks every kLookEvery.
  // now: s, never backwards.
  [[nodiscard]] bool HaveChanged(double now) {
    if (now < m_nextLook) return false;
    m_nextLook = now + kLookEvery;
    std::vector<Time> times = ReadTimes();
    if (times == m_times) return false;
    m_times = std::move(times);
    return true;
  }

  static constexpr double kLookEvery = 2;  // s

 private:
  using Time = std::filesystem::file_time_type;

  [[nodiscard]] std::vector<Time> ReadTimes() const {
    std::vector<Time> times;
    for (const std::string& path : m_paths) {
      std::error_code failure;
      const Time time = std::filesystem::last_write_time(path, failure);
      times.push_back(failure ? Time::min() : time);
    }
    return times;
  }

  std::vector<std::string> m_paths;
  std::vector<Time> m_times;
  double m_nextLook = 0;
};

}  // namespace wobble::gateway
