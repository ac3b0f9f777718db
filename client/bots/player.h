// One bot's presence in the world: joining, leaving, joining again, the events it receives, and sums over all its
// stays. A stay is the time from one Join to its end.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>

#include "client/client.h"

namespace wobble::bots {

class Player {
 public:
  // Events kept for a script that does not ask for them; the oldest are dropped first.
  static constexpr std::size_t kMaxEvents = 64;

  enum class State {
    kAway,  // not joined yet, or left
    kJoining,
    kPlaying,
    kLeaving,  // goodbye sent
    kLost,     // refused, disconnected or never answered; does not return
  };
  using OnSnapshot = std::function<void(const client::SnapshotArrival&)>;

  Player(client::Options options, OnSnapshot onSnapshot);

  // Begins a stay. Only in state kAway. The transport is connecting already.
  void Join(std::unique_ptr<transport::Transport> transport, double now);
  // Enters kLost because not even a connection could be begun.
  void Lose(std::string reason);
  // Says goodbye. Does nothing in kAway and kLost.
  void Leave(double now);
  // Advances the connection to `now` (seconds); may change the state.
  void Update(double now);
  // Ends measuring: only what was played until `now` counts.
  void StopMeasuring(double now);

  [[nodiscard]] State ReadState() const { return m_state; }
  // Null in kAway and kLost.
  [[nodiscard]] client::Client* Client() { return m_client.get(); }
  [[nodiscard]] const std::string& LossReason() const { return m_lossReason; }  // empty: the server never answered

  // Names of the players present, by body. Like Events(), covers the present stay only.
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::string>& Names() const { return m_names; }
  // Oldest first; the reader empties it.
  [[nodiscard]] std::deque<client::Client::Event>& Events() { return m_events; }

  // Sums over all stays, the present one up to the latest Update.
  struct Totals {
    std::uint64_t joins = 0;  // how often it reached play
    std::uint64_t snapshots = 0;
    std::uint64_t stalls = 0;
    double playedSeconds = 0;
    std::uint64_t playedBytes = 0;  // received while playing, transport headers included
  };
  [[nodiscard]] Totals ReadTotals() const;

 private:
  void HearEvent(const client::Client::Event& event);
  void AddPresentStay(double now, Totals& totals) const;
  void CloseConnection();

  client::Options m_options;
  OnSnapshot m_onSnapshot;
  State m_state = State::kAway;
  std::unique_ptr<client::Client> m_client;
  const transport::Transport* m_transport = nullptr;  // owned by m_client
  std::string m_lossReason;
  std::unordered_map<std::uint32_t, std::string> m_names;
  std::deque<client::Client::Event> m_events;

  Totals m_totals;          // of the stays that have ended
  bool m_measured = false;  // playing and not stopped measuring
  double m_playedFrom = 0;
  double m_updated = 0;           // time of the latest Update, seconds
  std::uint64_t m_bytesFrom = 0;  // the transport's byte count at m_playedFrom
};

}  // namespace wobble::bots
