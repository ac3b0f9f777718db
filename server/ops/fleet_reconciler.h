// Makes the fleet manager's record of this server agree with what the server wishes, whatever becomes of single calls:
// a call may be lost, refused, answered late, or take effect after it has been given up; the manager's sidecar may
// freeze, crash and forget. So the record is read again and again, and what differs is set again, in absolute terms.
//
// Plain data goes in and out: no socket, no clock, no JSON. agones.h makes the calls, one at a time.
//
// When a call has got no answer, nothing is set until the record has been read: only so can it be known whether the
// call took effect, and a sidecar that hangs is not given more that it might do later. A `ready` too many would offer a
// world in use to others.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/ops/fleet_duty.h"

namespace wobble::ops {

struct FleetCall {
  // kLook reads the record; all others write.
  enum class Kind : std::uint8_t { kHealth, kLook, kReady, kAllocate, kShutdown, kSetCount, kSetList };
  static constexpr std::size_t kKinds = 7;

  Kind kind = Kind::kHealth;
  std::int64_t count = 0;                // of kSetCount: players
  std::vector<std::string> values = {};  // of kSetList: one for each player

  bool operator==(const FleetCall&) const = default;
};

// The manager's record of this server.
struct FleetReport {
  // kEarly      not ready yet
  // kReady      may be given to players, now or soon
  // kAllocated  in use
  // kEnded      being removed, or given up as unhealthy: there is no way back
  enum class State : std::uint8_t { kUnknown, kEarly, kReady, kAllocated, kEnded };
  struct Counter {
    std::int64_t count = 0;
    std::int64_t capacity = 0;
  };
  struct List {
    std::vector<std::string> values;
    std::int64_t capacity = 0;
  };

  State state = State::kUnknown;
  std::optional<Counter> counter = {};  // nullopt: the fleet declares none
  std::optional<List> list = {};        // likewise
};

struct FleetAnswer {
  // kDone     accepted
  // kRefused  answered with an error, or with what cannot be read
  // kLost     no connection or no answer: it may have had its effect, or have it later
  enum class Outcome : std::uint8_t { kDone, kRefused, kLost };

  Outcome outcome = Outcome::kLost;
  FleetReport report = {};  // of kLook, when done
};

class FleetReconciler {
 public:
  // What is to be from now on. Cheap when nothing has changed.
  void Want(const FleetWish& wish);

  // The call to make now, if any; it must be made, and Learn be told of its answer, before the next Next. In this
  // order: health; what the state needs; a look; the count and the list of players.
  [[nodiscard]] std::optional<FleetCall> Next(double now);

  // began, now: s, when the call was made and when its answer came. Returns a line for the log when the record
  // contradicts what had been set, or cannot hold it; empty if there is nothing new to say.
  std::string Learn(const FleetCall& call, const FleetAnswer& answer, double began, double now);

  // Until then Next has no call unless the wish changes, s; after `now`.
  [[nodiscard]] double NextTime(double now) const;

  // What has been set again because the record had lost it.
  [[nodiscard]] std::uint64_t Corrections() const { return m_corrections; }

 private:
  using State = FleetReport::State;
  // One half of the record of players: what it is thought to hold. nullopt: not known.
  template <typename Value>
  struct Belief {
    std::optional<Value> held;
    bool isDeclared = true;
    std::int64_t capacity = std::numeric_limits<std::int64_t>::max();
    double set = -std::numeric_limits<double>::infinity();  // when it was last set or tried to, s
  };

  [[nodiscard]] std::optional<FleetCall::Kind> NextStateCall(double now) const;
  [[nodiscard]] std::int64_t WantedCount() const;
  [[nodiscard]] std::vector<std::string> WantedValues() const;
  void LearnChange(const FleetCall& call, bool isDone, double now);
  std::string LearnReport(const FleetReport& report, double began);
  [[nodiscard]] bool Agrees() const;

  FleetWish m_wish;
  std::vector<std::string> m_values;  // the wish's players as the list has them
  std::uint64_t m_heartbeats = 0;     // of the last health call
  State m_state = State::kUnknown;
  double m_stateSet = -std::numeric_limits<double>::infinity();  // s, likewise
  Belief<std::int64_t> m_count;
  Belief<std::vector<std::string>> m_list;  // sorted
  bool m_mustLook = false;
  double m_nextLook = std::numeric_limits<double>::infinity();  // s
  double m_nextShutdown = -std::numeric_limits<double>::infinity();
  std::string m_lastNote;
  std::uint64_t m_corrections = 0;
};

}  // namespace wobble::ops
