// A recording as a file: its head, and where its keyframes and seconds are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/recording/content.h"

namespace wobble::recording {

// Where a block is.
struct BlockPlace {
  std::uint64_t offset = 0;
  std::uint32_t tick = 0;  // of a keyframe; of a second, the ticks played before it
};

class Recording {
 public:
  // Reads the file once from beginning to end. Returns what is wrong, in words that follow the file's name; empty:
  // there is something to play. Any file is safe.
  [[nodiscard]] std::string Open(const std::filesystem::path& path);

  [[nodiscard]] const Head& ReadHead() const { return m_head; }
  [[nodiscard]] std::uint32_t FirstTick() const { return m_firstTick; }
  [[nodiscard]] std::uint32_t LastTick() const { return m_lastTick; }
  // Of a tick, s since the first.
  [[nodiscard]] double TimeOf(std::uint32_t tick) const { return (double{1} * tick - m_firstTick) / m_head.tickHz; }
  // What ended the reading before the file's end: damage, and at which byte; empty: nothing.
  [[nodiscard]] const std::string& Fault() const { return m_fault; }
  // Whether the recording was ended on purpose, and not by a crash or by what Fault says.
  [[nodiscard]] bool IsWhole() const { return m_isWhole; }

  // By tick.
  [[nodiscard]] const std::vector<BlockPlace>& Keyframes() const { return m_keyframes; }
  // The bytes of the keyframe there. Empty: the file has changed since it was opened.
  [[nodiscard]] Bytes ReadKeyframe(const BlockPlace& place);
  // The second in which the tick after so many is played; nullopt: there is none.
  [[nodiscard]] std::optional<Second> ReadSecond(std::uint32_t tick);

 private:
  [[nodiscard]] std::string Take(const Block& block);

  BlockReader m_file;
  Head m_head;
  std::vector<BlockPlace> m_keyframes;
  std::vector<BlockPlace> m_seconds;
  std::uint32_t m_firstTick = 0;
  std::uint32_t m_lastTick = 0;
  std::string m_fault;
  bool m_isWhole = false;
};

}  // namespace wobble::recording
