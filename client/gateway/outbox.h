// What waits to be written to one browser, each message with its channel in front.
//
// A WebSocket delivers everything in order, however late. Snapshots are worth nothing late, so the oldest of them give
// way to newer ones; all else waits for as long as it takes, up to a limit that only a browser which reads no more
// comes to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace wobble::web {

// Bytes. Snapshots: at the 384 kbit/s that a client is sent by default, 1.3 s of them. The other: eight times the
// largest blueprint.
inline constexpr std::size_t kMaxWaitingSnapshotBytes = 64 * 1024;
inline constexpr std::size_t kMaxWaitingBytes = 4 * 1024 * 1024;

class Outbox {
 public:
  using Message = std::vector<std::uint8_t>;

  // channel: as STANDARD.md numbers them over WebSockets.
  void Add(std::uint8_t channel, std::span<const std::uint8_t> bytes);

  // The oldest, which is no longer in it then. There must be one.
  [[nodiscard]] Message Take();

  void Clear() { *this = Outbox(m_dropped); }

  [[nodiscard]] bool IsEmpty() const { return m_messages.empty(); }
  [[nodiscard]] bool IsOverfull() const { return m_bytes > kMaxWaitingBytes; }
  // Snapshots that gave way, ever.
  [[nodiscard]] std::uint64_t CountDropped() const { return m_dropped; }

  Outbox() = default;

 private:
  explicit Outbox(std::uint64_t dropped) : m_dropped(dropped) {}

  void DropOldestSnapshot();

  std::deque<Message> m_messages;
  std::size_t m_bytes = 0;
  std::size_t m_snapshotBytes = 0;
  std::uint64_t m_dropped = 0;
};

}  // namespace wobble::web
