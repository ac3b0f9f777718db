// What one client has yet to be sent of the world's heights and blueprints, a window at a time.
//
// Reliable messages that arrive behind a lost one wait in the receiver's buffer. When that is full, ENet refuses the
// lost one as well, for ever: with everything sent at once one join in eighteen failed over 20 % loss. So at most
// protocol::kDownloadWindowBytes are on their way: sent, and not yet counted in the client's inputs.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "server/snapshots/blueprint_captures.h"
#include "server/snapshots/capture.h"

namespace wobble::server {

class Download {
 public:
  // Queues all heights, then the blueprint `first`, then the other blueprints of a scene, in place of what was queued
  // of the one before. kept: hashes of blueprints that the client has already.
  void Begin(std::size_t grounds, std::size_t blueprints, std::uint8_t first, std::span<const std::uint64_t> kept);
  // The blueprint is new or has changed. One that is on its way begins anew: no record names the old one any more.
  void Renew(std::uint8_t slot);

  // downloaded: bytes that the client has taken, as its newest inputs say; inputs may overtake one another. False, and
  // nothing changes, when that is more than was sent.
  [[nodiscard]] bool TakeReport(std::uint32_t downloaded);

  // Whether a client that has taken so many bytes knew of the scene that began last. Bytes count over all scenes of a
  // connection, and there is no play without a byte of the present one.
  [[nodiscard]] bool IsOfThisScene(std::uint32_t downloaded) const {
    return static_cast<std::int32_t>(downloaded - m_begunAt) > 0;
  }

  // Passes messages to `send` until the window is full or nothing is left.
  using SendFunction = std::function<void(const protocol::Message&)>;
  void SendDue(std::span<const CapturedGround> grounds, const BlueprintCaptures& blueprints, const SendFunction& send);

  [[nodiscard]] bool IsDone() const { return m_queue.empty(); }

  // How far the newest generation of a blueprint has come. Renew -> kUnsent -> kOnTheWay -> kArrived.
  enum class Stage : std::uint8_t { kUnsent, kOnTheWay, kArrived };
  [[nodiscard]] Stage Find(std::uint8_t slot) const { return m_stages[slot]; }

 private:
  struct Item {
    enum class Kind : std::uint8_t { kHeights, kBlueprint };
    Kind kind;
    std::uint8_t number;     // of the height field; slot of the blueprint
    std::size_t offset = 0;  // rows or bytes sent
  };
  void SendRows(Item& item, const CapturedGround& ground, const SendFunction& send);
  void SendChunk(Item& item, const CapturedBlueprint& blueprint, const SendFunction& send);

  // A blueprint on its way; arrived when the client has taken so many bytes.
  struct Awaited {
    std::uint8_t slot;
    std::uint32_t end;
  };

  std::deque<Item> m_queue;
  std::deque<Awaited> m_awaited;                           // by ascending end
  std::array<Stage, protocol::kMaxBlueprints> m_stages{};  // by slot
  std::vector<std::uint64_t> m_kept;
  std::uint32_t m_sent = 0;     // bytes; wraps like the client's count
  std::uint32_t m_taken = 0;    // of these
  std::uint32_t m_begunAt = 0;  // m_sent as the scene began
};

}  // namespace wobble::server
