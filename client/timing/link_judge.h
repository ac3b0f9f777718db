// When a link is no longer one to play over: the server is silent, or most of its packets are lost.
#pragma once

#include <cstdint>
#include <optional>

namespace wobble::client {

class LinkJudge {
 public:
  // now: seconds, never backwards, as in all of these.
  explicit LinkJudge(double now) : m_lastArrival(now), m_windowBegin(now) {}

  // Anything has come from the server.
  void NoteArrival(double now) { m_lastArrival = now; }

  // Whether nothing has come for `patience` seconds.
  [[nodiscard]] bool IsSilent(double now, double patience) const { return now - m_lastArrival >= patience; }

  struct Loss {
    std::uint32_t sent = 0;  // snapshot packets within the window, by their numbers
    std::uint64_t lost = 0;
  };
  // Judges once a window of 16 s. newestSequence: of the snapshot packets; arrived: how many of them have come so far.
  // The loss when it is too much to play, else nullopt.
  [[nodiscard]] std::optional<Loss> FindHeavyLoss(std::uint32_t newestSequence, std::uint64_t arrived, double now);

 private:
  double m_lastArrival;
  double m_windowBegin;
  // As they were when the window began.
  std::uint32_t m_windowSequence = 0;
  std::uint64_t m_windowArrived = 0;
};

}  // namespace wobble::client
