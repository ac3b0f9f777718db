// When a client that was cut off tries to join again, and when it gives up. Only decides; knows no connection.
//
// The waits double, up to a longest one, and each is shortened by chance: the players of a server that was restarted
// all lose it at the same moment and must not all return at the same moment.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/random.h"

namespace wobble::client {

struct RejoinOptions {
  double patience = 60;     // seconds without play after which it gives up; 0: it never joins again
  double firstWait = 0.25;  // seconds before the first try, above 0; doubled with each one that fails
  // Seconds, at least firstWait. However long a server was away, its players are back this long after it, and the time
  // of a join.
  double longestWait = 4;
  // Of the chance by which a wait is shortened, to half of it at most. Give each player another one.
  std::uint64_t seed = 1;
};

class RejoinPlan {
 public:
  explicit RejoinPlan(const RejoinOptions& options) : m_options(options), m_random(options.seed) {}

  // kNew:     has not played yet; an end is the last word.
  // kPlaying: plays.
  // kWaiting: was cut off; the next try begins when it is due.
  // kTrying:  a try is under way.
  // kOver:    has given up.
  enum class State : std::uint8_t { kNew, kPlaying, kWaiting, kTrying, kOver };
  [[nodiscard]] State ReadState() const { return m_state; }

  // now: seconds, never backwards, as in all of these.
  //
  // The client plays. Only in kNew and kTrying.
  void NotePlaying(double now);
  // The client, or the try, has ended. mayRejoin: whether it may end otherwise the next time (Client::MayRejoin).
  // Afterwards kWaiting or kOver.
  void NoteEnd(double now, bool mayRejoin);
  // True once for each try, when it is to begin; then kTrying. In kWaiting and kTrying: kOver when patience has run
  // out.
  [[nodiscard]] bool TakeDue(double now);

 private:
  void PlanTry(double now);

  RejoinOptions m_options;
  protocol::Random m_random;
  State m_state = State::kNew;
  double m_wait = 0;          // before the next try, not shortened; 0: firstWait
  double m_due = 0;           // of the next try
  double m_giveUpAt = 0;      // while not playing
  double m_playingSince = 0;  // while playing
};

// Seconds of play after which the next loss counts as a new one. Before that patience and waits go on from where they
// were, so that nobody follows for ever a server that lets players in and loses them again.
inline constexpr double kSettled = 10;

// Why it has given up, one line. lost: why the connection was lost; failure: of the last try, may be empty.
[[nodiscard]] std::string DescribeGivingUp(const std::string& lost, const std::string& failure,
                                           const RejoinOptions& options);

}  // namespace wobble::client
