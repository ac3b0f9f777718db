// How many bits a second one client's link has room for: the budget of its snapshots, measured instead of set.
//
// The rate grows while the budget is what limits what the client sees, and falls when packets queue or get lost. A
// bottleneck queues before it drops, so the round trip tells of it first; what is compared is the least round trip of a
// tenth of a second, because jitter only ever adds to it. So does congestion control for live media (Carlucci et al.,
// "Congestion control for web real-time communication", IEEE/ACM Trans. Netw. 25(5), 2017; RFC 8698), by the delay one
// way. Round trips need no clock of the client's, and its inputs are small and rarely queue.
#pragma once

#include <limits>

#include "protocol/acknowledgement.h"

namespace wobble::server {

// The rate that every link is taken to carry at first, bit/s, headers counted.
inline constexpr double kFirstRoom = 384e3;
// The rate below which nobody is pushed, bit/s: a link that is worse loses packets, and any packet alone shows
// something.
inline constexpr double kLeastRoom = 192e3;

class LinkRoom {
 public:
  // bit/s, headers counted; at most `ceiling`.
  [[nodiscard]] double Rate(double ceiling) const;

  // A packet of so many bytes has left, headers counted.
  void NoteSent(double bytes);
  void NoteAcknowledgement(const protocol::SentWindow::Report& report, double now);
  // Call it with every snapshot; decides anew four times a second. isShort: the budget has left bodies out or made them
  // coarser. ceiling: bit/s, above 0. now: s.
  void Follow(protocol::SentWindow& sent, bool isShort, double ceiling, double now);

 private:
  // kSeeking:   no limit has been met yet: the rate grows by a quarter at a time. -> kFollowing at the first one.
  // kFollowing: it grows by a twentieth, and backs off at every limit that it meets.
  enum class State { kSeeking, kFollowing };
  enum class Sign { kRoom, kUnclear, kFull };
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  void FollowLoss(const protocol::SentWindow::Tally& tally);
  [[nodiscard]] Sign ReadSign() const;
  void Grow(double ceiling);
  void BackOff(double now);

  // What happened since `begin`.
  struct Interval {
    double begin = 0;  // s
    double sentBytes = 0;
    unsigned sentPackets = 0;
    unsigned arrivedPackets = 0;                         // as acknowledgements told, whenever they were sent
    double roundTrip = kUnknown;                         // the least of its last tenth of a second, s
    [[nodiscard]] double FindUsed(double now) const;     // bit/s
    [[nodiscard]] double FindArrived(double now) const;  // bit/s
  };

  State m_state = State::kSeeking;
  double m_rate = kFirstRoom;
  double m_loss = 0;      // share of packets, smoothed
  double m_decision = 0;  // when the next one is due, s
  Interval m_interval;    // the one under way
  // The least round trip of the last minute, s: of its present half, begun at m_leastSince, and of the one before.
  double m_least = kUnknown;
  double m_leastBefore = kUnknown;
  double m_leastSince = 0;
};

}  // namespace wobble::server
