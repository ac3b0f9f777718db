// Answers strangers who ask what is played (protocol/server_query.h), on the door's thread.
//
// Only an address that shows its challenge is answered: four bytes of a keyed hash of address and time, so that nothing
// is remembered of who asks, and a forged address gets nine bytes for nine or more. Four bytes can be guessed, by who
// sends two thousand million queries; the rate of a subnet makes that a year for one answer.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/server_query.h"
#include "protocol/transport/net_address.h"
#include "protocol/transport/transport.h"
#include "protocol/transport/vestibule/keys.h"

namespace wobble::transport::vestibule {

// The newest picture on its way from the thread of the ticks to the door's. Neither waits for the other.
class PictureSlot {
 public:
  PictureSlot() = default;
  PictureSlot(const PictureSlot&) = delete;
  PictureSlot& operator=(const PictureSlot&) = delete;
  ~PictureSlot() { delete m_newest.load(); }

  // In place of one that has not been taken.
  void Put(std::unique_ptr<const protocol::ServerPicture> picture) { delete m_newest.exchange(picture.release()); }
  // Null: there has been no new one.
  [[nodiscard]] std::unique_ptr<const protocol::ServerPicture> Take() {
    return std::unique_ptr<const protocol::ServerPicture>(m_newest.exchange(nullptr));
  }

 private:
  std::atomic<const protocol::ServerPicture*> m_newest{nullptr};
};

class QueryDesk {
 public:
  // slot: null: nothing is answered.
  QueryDesk(std::shared_ptr<PictureSlot> slot, const RandomSource& random);

  // The datagrams of the answer; none before the first picture. Valid until the next call. now: s, above 0.
  [[nodiscard]] std::span<const std::vector<std::uint8_t>> Answer(const NetAddress& from, const protocol::Query& query,
                                                                  double now);
  [[nodiscard]] bool IsOpen() const { return m_slot != nullptr; }
  [[nodiscard]] const QueryCounts& Counts() const { return m_counts; }

 private:
  [[nodiscard]] std::uint32_t MakeChallenge(const NetAddress& from, std::uint64_t epoch) const;

  std::shared_ptr<PictureSlot> m_slot;
  Key m_key{};
  std::unique_ptr<const protocol::ServerPicture> m_picture;
  std::uint32_t m_number = 0;  // of the newest answer
  std::vector<std::vector<std::uint8_t>> m_answer;
  QueryCounts m_counts{};
};

}  // namespace wobble::transport::vestibule
