// The messages that wait to be written to one browser, each with its channel in front.
//
// A WebSocket delivers everything in order, however late. Late snapshots are worthless, so those that have waited too
// long give way to newer ones. Everything else waits as long as it takes, up to a limit that only a browser which has
// stopped reading reaches. Snapshots and the rest wait apart and leave in turn: a download does not hold back the
// picture, and the picture not the download.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace wobble::gateway {

// Seconds that a snapshot may wait. A bound in bytes would be short of one snapshot for a large world and a second of a
// slow line for a small one.
inline constexpr double kLongestWait = 0.15;
// In all, bytes: eight times the largest blueprint.
inline constexpr std::size_t kMaxWaitingBytes = 4 * 1024 * 1024;

class Outbox {
 public:
  using Message = std::vector<std::uint8_t>;

  // Adds a message that is not a snapshot. channel: as STANDARD.md numbers them over WebSockets.
  void Add(std::uint8_t channel, std::span<const std::uint8_t> bytes);
  // now: seconds, never backwards.
  void AddSnapshot(std::span<const std::uint8_t> bytes, double now);
  // Drops the snapshots that have waited too long.
  void DropLate(double now);

  // Removes and returns the next message: of snapshots and others the oldest in turn. There must be one.
  [[nodiscard]] Message Take();
  // The oldest snapshot. There must be one.
  [[nodiscard]] Message TakeSnapshot();
  [[nodiscard]] bool HasSnapshot() const { return !m_snapshots.empty(); }

  void Clear() { *this = Outbox(m_dropped); }

  [[nodiscard]] bool IsEmpty() const { return m_snapshots.empty() && m_others.empty(); }
  [[nodiscard]] bool IsOverfull() const { return m_bytes > kMaxWaitingBytes; }
  // Snapshots dropped so far.
  [[nodiscard]] std::uint64_t CountDropped() const { return m_dropped; }

  Outbox() = default;

 private:
  struct Snapshot {
    Message message;
    double since = 0;
  };
  explicit Outbox(std::uint64_t dropped) : m_dropped(dropped) {}

  std::deque<Snapshot> m_snapshots;
  std::deque<Message> m_others;
  std::size_t m_bytes = 0;
  bool m_isSnapshotNext = true;
  std::uint64_t m_dropped = 0;
};

}  // namespace wobble::gateway
