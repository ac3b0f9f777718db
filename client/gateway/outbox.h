// The messages that wait to be written to one browser, each with its channel in front.
//
// A WebSocket delivers everything in order, however late. Late snapshots are worthless, so the oldest of them give way
// to newer ones. Everything else waits as long as it takes, up to a limit that only a browser which has stopped reading
// reaches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace wobble::gateway {

// Bytes. Snapshots: 1.3 s of them at the default 384 kbit/s a client. In all: eight times the largest blueprint.
inline constexpr std::size_t kMaxWaitingSnapshotBytes = 64 * 1024;
inline constexpr std::size_t kMaxWaitingBytes = 4 * 1024 * 1024;

class Outbox {
 public:
  using Message = std::vector<std::uint8_t>;

  // Adds a message. channel: as STANDARD.md numbers them over WebSockets.
  void Add(std::uint8_t channel, std::span<const std::uint8_t> bytes);

  // Removes and returns the oldest message. There must be one.
  [[nodiscard]] Message Take();

  void Clear() { *this = Outbox(m_dropped); }

  [[nodiscard]] bool IsEmpty() const { return m_messages.empty(); }
  [[nodiscard]] bool IsOverfull() const { return m_bytes > kMaxWaitingBytes; }
  // Snapshots dropped so far.
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

}  // namespace wobble::gateway
