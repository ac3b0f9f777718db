// The thread at the door: receives from the public socket, asks the door, answers, and hands plain datagrams to ENet's
// thread through a socket pair.
//
// Strangers' datagrams cost this thread's time and never the tick's. Receiving happens here, sending to visitors on
// ENet's thread (enet_bridge.h), through the same socket.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "protocol/transport/vestibule/door.h"
#include "protocol/transport/vestibule/udp_socket.h"

namespace wobble::transport::vestibule {

// What stands before each message in the pair. kNew: a Leg follows, and nothing else of this visitor came before.
// kData: a plain datagram follows. kOffence: the visitor is to be sent away. kGone: the door has removed it.
struct PairHead {
  enum class Kind : std::uint32_t { kNew, kData, kOffence, kGone };
  VisitorId visitor = 0;
  Kind kind = Kind::kData;
};

class Doorkeeper {
 public:
  // pairEnd: the end to write to; the keeper closes it. Its other end is ENet's.
  Doorkeeper(UdpSocket socket, Door door, int pairEnd);
  ~Doorkeeper();

  // From any thread. See Door::Release and Door::Remove.
  void Release(VisitorId visitor) { Leave(visitor, false); }
  void Remove(VisitorId visitor) { Leave(visitor, true); }

  [[nodiscard]] const UdpSocket& Socket() const { return m_socket; }
  [[nodiscard]] const Key& ServerKey() const { return m_serverKey; }
  // As of the last turn of the thread.
  [[nodiscard]] DoorCounts ReadCounts() const;
  [[nodiscard]] std::uint64_t BytesIn() const { return m_bytesIn.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t BytesOut() const { return m_bytesOut.load(std::memory_order_relaxed); }

 private:
  void Leave(VisitorId visitor, bool isGone);
  void Run();
  void JudgeFlood(double now);
  void TakeLeavers();
  void TakeDatagram(const NetAddress& from, std::span<const std::uint8_t> datagram, double now);
  void HandOn(VisitorId visitor, PairHead::Kind kind, std::span<const std::uint8_t> bytes);
  void WriteToPair();

  UdpSocket m_socket;
  Door m_door;
  Key m_serverKey;
  int m_pairEnd;
  SendBatch m_answers;
  std::deque<std::vector<std::uint8_t>> m_toPair;
  std::vector<VisitorId> m_overdue;  // scratch
  double m_nextOverdue = 0;
  double m_strangersFrom = 0;  // s, since when they are counted
  unsigned m_strangers = 0;    // datagrams that belong to no visitor
  bool m_isFlooded = false;
  std::atomic<std::uint64_t> m_bytesIn{0};
  std::atomic<std::uint64_t> m_bytesOut{0};

  mutable std::mutex m_mutex;  // over what follows
  struct Leaver {
    VisitorId visitor;
    bool isGone;
  };
  std::vector<Leaver> m_leavers;
  DoorCounts m_counts;
  bool m_isStopping = false;

  std::thread m_thread;  // last: everything else is there when it begins
};

}  // namespace wobble::transport::vestibule
