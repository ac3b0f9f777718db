// One bot's presence in the world: joining, leaving, joining again, the events it receives, and sums over all its
// stays. A stay is the time from one Join to its end; a bot that was cut off and joins again by itself goes on with it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>

#include "client/client.h"
#include "client/rejoin.h"

namespace wobble::bots {

class Player {
 public:
  // Events kept for a script that does not ask for them; the oldest are dropped first.
  static constexpr std::size_t kMaxEvents = 64;

  enum class State {
    kAway,  // not joined yet, or left
    kJoining,
    kPlaying,
    kRejoining,  // cut off; waits for the next try or tries
    kLeaving,    // goodbye sent
    kLost,       // refused, disconnected or never answered; does not return
  };
  using OnSnapshot = std::function<void(const client::SnapshotArrival&)>;

  Player(client::Options options, const client::RejoinOptions& rejoin, OnSnapshot onSnapshot);

  // Begins a stay. Only in state kAway. The transport is connecting already.
  void Join(std::unique_ptr<transport::Transport> transport, double now);
  // Whether the next try to join again is to begin; true once for each, which Rejoin or FailToRejoin answers. In
  // kRejoining; may enter kLost.
  [[nodiscard]] bool TakeRejoinDue(double now);
  void Rejoin(std::unique_ptr<transport::Transport> transport, double now);
  // Not even a connection could be begun.
  void FailToRejoin(const std::string& reason, double now);
  // Enters kLost because not even a connection could be begun.
  void Lose(std::string reason);
  // Says goodbye. Does nothing in kAway and kLost.
  void Leave(double now);
  // Advances the connection to `now` (seconds); may change the state.
  void Update(double now);
  // Ends measuring: only what was played until `now` counts.
  void StopMeasuring(double now);

  [[nodiscard]] State ReadState() const { return m_state; }
  // Null in kAway and kLost, and in kRejoining while it waits.
  [[nodiscard]] client::Client* Client() { return m_client.get(); }
  // Whether somebody in charge kicked or banned it; then it is in kLost.
  [[nodiscard]] bool WasSentAway() const { return m_wasSentAway; }
  // Why it was lost, or cut off last. Empty: the server never answered.
  [[nodiscard]] const std::string& LossReason() const { return m_lossReason; }
  // To come back with: of the connection before.
  [[nodiscard]] const std::vector<std::uint8_t>& Ticket() const { return m_ticket; }
  // When it was cut off last, seconds.
  [[nodiscard]] double CutAt() const { return m_cutAt; }

  // Names of the players present, by body. Like Events(), covers the present connection only, and its present scene.
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::string>& Names() const { return m_names; }
  // Bodies of the players present, by client.
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::uint32_t>& Bodies() const { return m_bodies; }
  // Oldest first; the reader empties it.
  [[nodiscard]] std::deque<client::Client::Event>& Events() { return m_events; }

  // Sums over all stays, the present one up to the latest Update.
  struct Totals {
    std::uint64_t joins = 0;    // how often it reached play
    std::uint64_t cuts = 0;     // how often it was cut off while it played and tried to come back
    std::uint64_t rejoins = 0;  // how often it came back; in joins, too
    std::uint64_t snapshots = 0;
    std::uint64_t stalls = 0;
    double playedSeconds = 0;
    std::uint64_t playedBytes = 0;  // received while playing, transport headers included
  };
  [[nodiscard]] Totals ReadTotals() const;

 private:
  void Connect(std::unique_ptr<transport::Transport> transport, double now);
  void NoteEnd(double now);
  void NotePlaying(double now);
  void HearEvent(const client::Client::Event& event);
  void AddPresentStay(double now, Totals& totals) const;
  void CloseConnection();

  client::Options m_options;
  OnSnapshot m_onSnapshot;
  State m_state = State::kAway;
  bool m_wasSentAway = false;
  std::unique_ptr<client::Client> m_client;
  const transport::Transport* m_transport = nullptr;  // owned by m_client
  std::string m_lossReason;
  std::vector<std::uint8_t> m_ticket;
  client::RejoinOptions m_rejoin;
  client::RejoinPlan m_plan;  // of the present stay
  double m_cutAt = 0;
  std::unordered_map<std::uint32_t, std::string> m_names;
  std::unordered_map<std::uint32_t, std::uint32_t> m_bodies;
  std::deque<client::Client::Event> m_events;

  Totals m_totals;          // of the stays that have ended
  bool m_measured = false;  // playing and not stopped measuring
  double m_playedFrom = 0;
  double m_updated = 0;           // time of the latest Update, seconds
  std::uint64_t m_bytesFrom = 0;  // the transport's byte count at m_playedFrom
};

}  // namespace wobble::bots
