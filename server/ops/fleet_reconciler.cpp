// Each part of the record (state, count, list) has a belief: what the manager is thought to hold. A call that was
// accepted makes a belief; a look replaces it. A part is set when belief and wish differ.
#include "server/ops/fleet_reconciler.h"

#include <algorithm>
#include <utility>

namespace wobble::ops {
namespace {

using State = FleetReport::State;

// s. Agones' sidecar answers at once but writes what it was told in batches, half a second or a second apart, and the
// record shows it only then. So for this time after a part has been set a look says nothing about it; and a list that
// is set again before the batch has been written takes back what is in the batch.
constexpr double kSettleTime = 2;
// Between looks while all agrees, s. A call that was given up may still take effect minutes later.
constexpr double kLookInterval = 5;

State FindWantedState(FleetWish::State wish) {
  switch (wish) {
    case FleetWish::State::kStarting:
      return State::kUnknown;
    case FleetWish::State::kReady:
      return State::kReady;
    case FleetWish::State::kAllocated:
      return State::kAllocated;
    case FleetWish::State::kShutdown:
      return State::kEnded;
  }
  return State::kUnknown;
}

const char* FindName(State state) {
  switch (state) {
    case State::kUnknown:
      return "unknown";
    case State::kEarly:
      return "not ready";
    case State::kReady:
      return "ready";
    case State::kAllocated:
      return "allocated";
    case State::kEnded:
      return "ended";
  }
  return "";
}

bool IsCounting(FleetWish::State wish, State state) {
  return (wish == FleetWish::State::kReady || wish == FleetWish::State::kAllocated) &&
         (state == State::kReady || state == State::kAllocated);
}

template <typename Belief, typename Value>
bool IsDue(const Belief& belief, const Value& wanted) {
  return belief.isDeclared && belief.held != wanted;
}

void AddTo(std::string& note, const std::string& text) {
  if (!note.empty()) note += "; ";
  note += text;
}

// What a look says of a counter or list, into its belief; seen: null where the fleet declares none. Returns whether the
// record has lost what it was thought to hold.
template <typename Belief, typename Value>
bool LearnPart(Belief& belief, const Value* seen, std::int64_t capacity, double began) {
  belief.isDeclared = seen != nullptr;
  if (seen == nullptr) return false;
  belief.capacity = capacity;
  if (began < belief.set + kSettleTime) return false;
  const bool isLost = belief.held && *belief.held != *seen;
  belief.held = *seen;
  return isLost;
}

}  // namespace

void FleetReconciler::Want(const FleetWish& wish) {
  if (wish == m_wish) return;
  if (wish.players != m_wish.players) {
    m_values.clear();
    for (const std::uint32_t player : wish.players) m_values.push_back("player-" + std::to_string(player));
    std::ranges::sort(m_values);
  }
  m_wish = wish;
}

std::optional<FleetCall> FleetReconciler::Next(double now) {
  using Kind = FleetCall::Kind;
  if (std::exchange(m_heartbeats, m_wish.heartbeats) != m_wish.heartbeats) return FleetCall{.kind = Kind::kHealth};
  if (const auto kind = NextStateCall(now)) return FleetCall{.kind = *kind};
  if (now >= m_nextLook) return FleetCall{.kind = Kind::kLook};
  if (m_mustLook || !IsCounting(m_wish.state, m_state)) return {};
  if (now >= m_count.set + kSettleTime && IsDue(m_count, WantedCount())) {
    return FleetCall{.kind = Kind::kSetCount, .count = WantedCount()};
  }
  if (now >= m_list.set + kSettleTime && IsDue(m_list, WantedValues())) {
    return FleetCall{.kind = Kind::kSetList, .values = WantedValues()};
  }
  return {};
}

// Shutdown alone waits for no look: it does no harm twice, and the server may be about to end.
std::optional<FleetCall::Kind> FleetReconciler::NextStateCall(double now) const {
  using Kind = FleetCall::Kind;
  if (m_wish.state == FleetWish::State::kShutdown) {
    if (m_state != State::kEnded && now >= m_nextShutdown) return Kind::kShutdown;
    return {};
  }
  if (m_wish.state == FleetWish::State::kStarting || m_mustLook) return {};
  if (m_state == State::kUnknown || m_state == State::kEarly) return Kind::kReady;
  if (m_wish.state == FleetWish::State::kAllocated && m_state == State::kReady) return Kind::kAllocate;
  return {};
}

double FleetReconciler::NextTime(double now) const {
  double time = m_nextLook;
  if (m_wish.state == FleetWish::State::kShutdown && m_state != State::kEnded) time = std::min(time, m_nextShutdown);
  if (!m_mustLook && IsCounting(m_wish.state, m_state)) {
    if (IsDue(m_count, WantedCount())) time = std::min(time, m_count.set + kSettleTime);
    if (IsDue(m_list, WantedValues())) time = std::min(time, m_list.set + kSettleTime);
  }
  return std::max(time, now);
}

std::int64_t FleetReconciler::WantedCount() const {
  return std::min(static_cast<std::int64_t>(m_values.size()), m_count.capacity);
}

std::vector<std::string> FleetReconciler::WantedValues() const {
  const std::int64_t size = std::min(static_cast<std::int64_t>(m_values.size()), m_list.capacity);
  return {m_values.begin(), m_values.begin() + size};
}

std::string FleetReconciler::Learn(const FleetCall& call, const FleetAnswer& answer, double began, double now) {
  const bool isDone = answer.outcome == FleetAnswer::Outcome::kDone;
  const bool isLook = call.kind == FleetCall::Kind::kLook;
  std::string note;
  if (isLook) {
    m_mustLook = false;
    if (isDone) note = LearnReport(answer.report, began);
    m_nextLook = now + (isDone && Agrees() ? kLookInterval : kSettleTime);
  } else if (call.kind != FleetCall::Kind::kHealth) {
    LearnChange(call, isDone, now);
  }
  if (answer.outcome == FleetAnswer::Outcome::kLost) {
    m_mustLook = true;
    m_nextLook = std::min(m_nextLook, now + kSettleTime);
  }
  if (!isLook || !isDone || note == m_lastNote) return {};
  m_lastNote = note;
  return note;
}

// A state that was not accepted stays what it was thought to be, so that a refused `allocate` is never followed by a
// `ready`. Count and list may be set at any time, so they become unknown.
void FleetReconciler::LearnChange(const FleetCall& call, bool isDone, double now) {
  switch (call.kind) {
    case FleetCall::Kind::kReady:
    case FleetCall::Kind::kAllocate:
    case FleetCall::Kind::kShutdown:
      m_stateSet = now;
      if (call.kind == FleetCall::Kind::kShutdown) m_nextShutdown = now + kSettleTime;
      if (!isDone) break;
      m_state = call.kind == FleetCall::Kind::kReady      ? State::kReady
                : call.kind == FleetCall::Kind::kAllocate ? State::kAllocated
                                                          : State::kEnded;
      break;
    case FleetCall::Kind::kSetCount:
      m_count.set = now;
      m_count.held = isDone ? std::optional(call.count) : std::nullopt;
      break;
    case FleetCall::Kind::kSetList:
      m_list.set = now;
      m_list.held = isDone ? std::optional(call.values) : std::nullopt;
      break;
    case FleetCall::Kind::kHealth:
    case FleetCall::Kind::kLook:
      return;
  }
  if (!isDone) m_mustLook = true;
  m_nextLook = std::min(m_nextLook, now + kSettleTime);
}

std::string FleetReconciler::LearnReport(const FleetReport& report, double began) {
  std::string note;
  if (report.state != State::kUnknown && began >= m_stateSet + kSettleTime) {
    if (report.state < m_state && report.state < FindWantedState(m_wish.state)) {
      ++m_corrections;
      AddTo(note, std::string("this server is ") + FindName(report.state) + " and not " + FindName(m_state));
    }
    if (report.state == State::kEnded && m_wish.state != FleetWish::State::kShutdown) {
      AddTo(note, "this server is being removed");
    }
    m_state = report.state;
  }
  if (!IsCounting(m_wish.state, m_state)) return note;
  const auto learn = [&](auto& belief, const auto* seen, std::int64_t capacity, const std::string& part) {
    const bool isLost = LearnPart(belief, seen, capacity, began);
    m_corrections += isLost ? 1 : 0;
    if (isLost) AddTo(note, part + " is not what was set");
    if (seen == nullptr) AddTo(note, "the fleet declares no " + part);
    if (seen != nullptr && capacity < static_cast<std::int64_t>(m_values.size())) {
      AddTo(note, part + " has room for " + std::to_string(capacity) + " only");
    }
  };
  learn(m_count, report.counter ? &report.counter->count : nullptr, report.counter ? report.counter->capacity : 0,
        "counter of players");
  learn(m_list, report.list ? &report.list->values : nullptr, report.list ? report.list->capacity : 0,
        "list of players");
  return note;
}

bool FleetReconciler::Agrees() const {
  if (m_state < FindWantedState(m_wish.state)) return false;
  return !IsCounting(m_wish.state, m_state) || (!IsDue(m_count, WantedCount()) && !IsDue(m_list, WantedValues()));
}

}  // namespace wobble::ops
