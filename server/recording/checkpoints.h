// Keeps the state of a server's world in files, from which a server goes on after it was killed at any moment.
//
// A checkpoint is written beside the last ones, and takes the place of the oldest when it is whole: a rename is all or
// nothing. The last kKept are there, so that one that a dying disk has spoiled costs a second, not the world.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/recording/content.h"

namespace wobble::recording {

// By what a player who comes back is known: a hash of a secret that only they have. All zeros: not known.
using Identity = std::array<std::uint8_t, 16>;

struct Checkpoint {
  std::uint64_t number = 0;  // of the checkpoints of a world: the largest is the newest
  server::PlaygroundState ground;
  server::ClientId nextClient = 1;
  std::map<server::ClientId, Identity> seats;  // of the players in
  std::size_t scene = 0;                       // which of the heads it is of; stands in the file as that head
};

struct FoundCheckpoint {
  std::optional<Checkpoint> checkpoint;  // the newest that is whole and of one of the heads
  std::vector<std::string> complaints;   // one line each: files that are not, and why
  // The newest that is whole is of another world, which one and which is wanted: a line; empty: it is not. A checkpoint
  // that is saved all the same takes the other world's place.
  std::string conflict;
};

class Checkpoints {
 public:
  static constexpr std::size_t kKept = 3;

  // folder: is there and can be written. heads: what the world may be of, one for each scene of a rotation; beginsFresh
  // is not looked at.
  Checkpoints(std::filesystem::path folder, std::vector<Head> heads);
  // Writes the last one that was given.
  ~Checkpoints();
  Checkpoints(const Checkpoints&) = delete;
  Checkpoints& operator=(const Checkpoints&) = delete;

  // Keeps other servers off the folder as long as this object lives, whatever ends the process. Returns what is wrong,
  // with the process that has it; empty: nothing. Where the file system knows no locks nobody is kept off.
  [[nodiscard]] std::string Claim();

  // Reads the folder. A checkpoint of another scene, tick rate or seed is not of the heads. Call it before the first
  // Save.
  [[nodiscard]] FoundCheckpoint FindNewest();

  // Writes it on another thread; numbers it. One that is still waiting gives way.
  void Save(Checkpoint checkpoint);

  // Checkpoints that could not be written, and why the last one could not.
  [[nodiscard]] std::uint64_t Failures() const;
  [[nodiscard]] std::string Error() const;

 private:
  // Leaves in `conflict` how its world differs; empty: it is of one of the heads. Returns what is wrong with the file.
  [[nodiscard]] std::string Read(const std::filesystem::path& path, Checkpoint& checkpoint,
                                 std::string& conflict) const;
  [[nodiscard]] std::string DescribeConflict(const Head& found) const;
  void Run();
  void Write(const Checkpoint& checkpoint);

  std::filesystem::path m_folder;
  std::vector<Bytes> m_heads;  // as they stand in the files
  std::uint64_t m_number = 0;
  int m_lock = -1;  // a file that is locked as long as it is open; -1: none

  mutable std::mutex m_mutex;  // over what follows
  std::condition_variable m_wakes;
  std::optional<Checkpoint> m_waiting;
  bool m_isClosing = false;
  std::uint64_t m_failures = 0;
  std::string m_error;

  std::thread m_thread;
};

}  // namespace wobble::recording
