// Keyframes of a recording every two seconds, so that any tick is two seconds of play away. They are made once, on a
// thread of their own, and kept in a file beside the recording.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/recording/recording.h"

namespace wobble::recording {

inline constexpr std::uint32_t kIndexSeconds = 2;

class KeyframeIndex {
 public:
  // path: of the recording, which can be read. The index is read from FILE.wobidx if it is there and of this recording;
  // otherwise it is made, and kept there if that can be written.
  explicit KeyframeIndex(std::filesystem::path path);
  // Breaks off what is being made.
  ~KeyframeIndex();
  KeyframeIndex(const KeyframeIndex&) = delete;
  KeyframeIndex& operator=(const KeyframeIndex&) = delete;

  struct Keyframe {
    std::uint32_t tick = 0;
    Bytes bytes;  // of a server::PlaygroundState
  };
  // The last one up to this tick that is made already.
  [[nodiscard]] std::optional<Keyframe> Find(std::uint32_t tick) const;
  // The tick up to which it is made.
  [[nodiscard]] std::uint32_t MadeUpTo() const { return m_madeUpTo; }

 private:
  [[nodiscard]] std::filesystem::path Path() const { return m_path.string() + ".wobidx"; }
  [[nodiscard]] Bytes MakeHead(const Recording& recording) const;
  bool Load(const Recording& recording);
  void Make();
  void Keep(const Recording& recording) const;

  std::filesystem::path m_path;
  std::atomic<bool> m_isStopped{false};
  std::atomic<std::uint32_t> m_madeUpTo{0};
  mutable std::mutex m_mutex;                  // over what follows
  std::map<std::uint32_t, Bytes> m_keyframes;  // packed, by tick
  std::thread m_thread;
};

}  // namespace wobble::recording
