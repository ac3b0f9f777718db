// Plays a recording again: the same entries at the same ticks in a playground of the same scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/recording/content.h"

namespace wobble::recording {

// What of a recording's world differs from the one that is played, in the first tick that does.
struct Difference {
  std::uint32_t tick = 0;
  double second = 0;                    // s since the recording began
  std::optional<physics::BodyId> body;  // the first whose hash differs within a second; nullopt: only samples differ
};

struct ReplaySettings {
  // How the playground is played; the bits do not depend on it.
  int threads = 1;
  int widestPack = physics::WorldSettings{}.widestPack;
};

// Where a block is.
struct BlockPlace {
  BlockKind kind = BlockKind::kSecond;
  std::uint64_t offset = 0;
  std::uint32_t tick = 0;  // of a keyframe; of a second, the ticks played before it
};

class Replay {
 public:
  // Reads the file once from beginning to end. Null, and what is wrong in `error`, in words that follow the file's
  // name, unless there is something to play. Any file is safe.
  [[nodiscard]] static std::unique_ptr<Replay> Open(const std::filesystem::path& path, const ReplaySettings& settings,
                                                    std::string& error);

  [[nodiscard]] const server::Playground& Ground() const { return *m_ground; }
  [[nodiscard]] const Head& ReadHead() const { return m_head; }
  [[nodiscard]] std::uint32_t FirstTick() const { return m_firstTick; }
  [[nodiscard]] std::uint32_t LastTick() const { return m_lastTick; }
  [[nodiscard]] double Duration() const { return double{1} * (m_lastTick - m_firstTick) / m_head.tickHz; }  // s
  // What ended the reading before the file's end: damage, and at which byte; empty: nothing.
  [[nodiscard]] const std::string& Fault() const { return m_fault; }
  // Whether the recording was ended on purpose, and not by a crash or by what Fault says.
  [[nodiscard]] bool IsWhole() const { return m_isWhole; }

  // Plays the next tick. False, and nothing is played, at the end.
  bool Advance();
  // Goes to the state after so many ticks, from FirstTick to LastTick, by the nearest keyframe before it. Returns what
  // is wrong with the file, or empty.
  [[nodiscard]] std::string Seek(std::uint32_t tick);
  // What of the world differed from the recorded one, at the first tick since the last Seek that did.
  [[nodiscard]] const std::optional<Difference>& FirstDifference() const { return m_difference; }

  // All keyframes of the file, by tick.
  [[nodiscard]] const std::vector<BlockPlace>& Keyframes() const { return m_keyframes; }
  // Whether the whole state is now that of the keyframe, to the bit.
  [[nodiscard]] bool Matches(const BlockPlace& keyframe);

 private:
  Replay(const ReplaySettings& settings) : m_settings(settings) {}
  [[nodiscard]] std::string ReadAll(const std::filesystem::path& path);
  [[nodiscard]] std::string Take(const Block& block);
  [[nodiscard]] std::string MakeGround();
  // The state of the keyframe block there.
  [[nodiscard]] std::optional<server::PlaygroundState> ReadKeyframe(std::uint64_t offset);
  // Makes m_second the one with the tick that follows. False: there is none.
  bool FindSecond(std::uint32_t tick);
  void TakeEntries();
  void Compare();

  ReplaySettings m_settings;
  BlockReader m_file;
  Head m_head;
  std::vector<BlockPlace> m_keyframes;
  std::vector<BlockPlace> m_seconds;
  std::uint32_t m_firstTick = 0;
  std::uint32_t m_lastTick = 0;
  std::string m_fault;
  bool m_isWhole = false;
  std::unique_ptr<server::Playground> m_ground;
  Second m_second;              // that is being played
  std::size_t m_nextEntry = 0;  // of m_second
  std::optional<Difference> m_difference;
};

}  // namespace wobble::recording
