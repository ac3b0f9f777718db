// One bot's place in the world: it joins, may leave and join again; whom it hears of, and what all its stays add up to.
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
  // Events kept for a script that does not ask for them; older ones are forgotten.
  static constexpr std::size_t kMaxEvents = 64;

  enum class State {
    kAway,  // not there yet, or has left
    kJoining,
    kPlaying,
    kLeaving,  // has said goodbye
    kLost,     // sent away, dropped or never answered: it does not come back
  };
  using OnSnapshot = std::function<void(const client::SnapshotArrival&)>;

  Player(client::Options options, OnSnapshot onSnapshot);

  // To be called when away. The transport is one that is connecting already.
  void Join(std::unique_ptr<transport::Transport> transport, double now);
  // No connection could even be begun.
  void Lose(std::string reason);
  // Nothing when away or lost.
  void Leave(double now);
  // Moves all on to `now`; afterwards ReadState() may be another.
  void Update(double now);
  // What was played so far is all that counts.
  void StopMeasuring(double now);

  [[nodiscard]] State ReadState() const { return m_state; }
  // Null when away or lost.
  [[nodiscard]] client::Client* Client() { return m_client.get(); }
  [[nodiscard]] const std::string& LossReason() const { return m_lossReason; }  // empty: nobody answered

  // Names of the players that are in, by body; of the present stay, as is what follows.
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::string>& Names() const { return m_names; }
  // Oldest first; whoever reads them empties it.
  [[nodiscard]] std::deque<client::Client::Event>& Events() { return m_events; }

  // Sums over all stays, the present one up to the latest Update.
  struct Totals {
    std::uint64_t joins = 0;  // times that it reached play
    std::uint64_t snapshots = 0;
    std::uint64_t stalls = 0;
    double playedSeconds = 0;
    std::uint64_t playedBytes = 0;  // received in that time, transport's headers included
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
  const transport::Transport* m_transport = nullptr;  // the client's
  std::string m_lossReason;
  std::unordered_map<std::uint32_t, std::string> m_names;
  std::deque<client::Client::Event> m_events;

  Totals m_totals;          // of the stays that are over
  bool m_measured = false;  // playing, and it counts
  double m_playedFrom = 0;
  double m_updated = 0;           // the latest Update
  std::uint64_t m_bytesFrom = 0;  // the transport's count at m_playedFrom
};

}  // namespace wobble::bots
