// Records a playground into files while it is played. The thread that plays notes what enters and leaves the rest, from
// bytes to the disk, to another thread: a slow or full disk loses a recording, and never a tick.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "server/recording/content.h"

namespace wobble::recording {

struct RecorderSettings {
  std::filesystem::path folder;
  std::uint64_t maxFileBytes = std::uint64_t{256} << 20;  // then the next file begins
  std::function<std::uint64_t()> readUnixTime;            // s since 1970; called from the writing thread
};

struct RecorderCounts {
  std::uint64_t files = 0;
  std::uint64_t bytes = 0;
  std::uint64_t failures = 0;   // files that were broken off because the disk or the writing thread failed
  std::uint64_t lostTicks = 0;  // that were played and are in no file
};

class Recorder {
 public:
  // head: of all files, but for beginsFresh, until BeginScene. ground: as it stands before what is recorded; nobody is
  // in unless it was resumed.
  Recorder(RecorderSettings settings, Head head, const server::Playground& ground);
  // Writes what is there and ends the file.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // What enters the playground, which is at this tick.
  void Note(const server::Entry& entry, std::uint32_t tick);
  // Call it after each tick of the playground.
  void FollowTick(const server::Playground& ground);
  // The next tick ends the file and begins another, as does a RestartEntry: a match is over.
  void BeginFile() { m_wantsFile = true; }

  // Another playground is played from here on, of this scene and otherwise the same head: ends the file and begins
  // another. ground: as it begins, nobody is in.
  void BeginScene(scenes::SceneSource scene, const server::Playground& ground);

  // Waits until all that is noted is written and ends the file; nothing is noted after it.
  void Close();

  [[nodiscard]] RecorderCounts Counts() const;
  // Why the last file was broken off; empty while none was.
  [[nodiscard]] std::string Error() const;
  [[nodiscard]] std::filesystem::path Path() const;  // of the file that is being written

 private:
  // kWriting: -> kBroken when the writing thread has failed or is too far behind. kBroken: notes nothing; -> kWriting,
  // with a new file, after kRetryTicks.
  enum class State { kWriting, kBroken };
  struct FileBegin {
    Head head;
  };
  struct FileEnd {};
  using Job = std::variant<FileBegin, Second, server::PlaygroundState, FileEnd>;

  void Enqueue(Job job, std::size_t bytes);
  void StartFile(const server::Playground& ground, bool beginsFresh);
  void EnqueueKeyframe(const server::Playground& ground);
  void StartSecond(std::uint32_t tick);
  void EndSecond();

  // The writing thread:
  void Write();
  void Do(const FileBegin& begin);
  void Do(const Second& second);
  void Do(const server::PlaygroundState& state);
  void Do(const FileEnd& end);
  void Append(std::span<const std::uint8_t> bytes);
  void Fail(const std::string& why);
  void CountLost(std::size_t ticks);
  void TakeBack();
  [[nodiscard]] std::filesystem::path MakePath(const std::string& scene);

  RecorderSettings m_settings;
  Head m_head;
  State m_state = State::kWriting;
  std::uint32_t m_brokenTicks = 0;
  bool m_wantsFile = false;
  Second m_second;
  std::uint32_t m_ticksInFile = 0;

  mutable std::mutex m_mutex;  // over what follows
  std::condition_variable m_wakes;
  std::deque<std::pair<Job, std::size_t>> m_jobs;
  std::size_t m_queuedBytes = 0;
  bool m_isClosing = false;
  RecorderCounts m_counts;
  std::string m_error;
  std::filesystem::path m_path;

  std::atomic<bool> m_hasFailed{false};       // the file being written
  std::atomic<std::uint64_t> m_fileBytes{0};  // of the file being written
  // Of the writing thread alone:
  int m_file = -1;
  bool m_isWorthKeeping = false;  // the file has a second

  std::thread m_thread;
};

}  // namespace wobble::recording
