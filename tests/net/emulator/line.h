// Carries IP packets between two devices under the conditions of a link.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <queue>
#include <vector>

#include "protocol/transport/link_conditions.h"
#include "protocol/transport/link_emulation.h"

namespace wobble::emulator {

struct LineCounts {
  std::uint64_t passed = 0, lost = 0, bytes = 0;
};

class Line {
 public:
  // server, client: devices that do not block, whose each read is one packet. What the client's end sends is `up`.
  Line(const transport::LinkSpec& spec, std::uint64_t seed, int server, int client);

  // Carries packets until the flag is set. Blocks for at most 20 ms at a time.
  void Run(const std::atomic<bool>& isOver);
  [[nodiscard]] const LineCounts& CountUp() const { return m_ways[0].counts; }
  [[nodiscard]] const LineCounts& CountDown() const { return m_ways[1].counts; }

 private:
  struct Packet {
    double due = 0;
    std::uint64_t number = 0;  // packets of the same moment leave in the order in which they came
    std::vector<std::uint8_t> bytes;
    bool operator<(const Packet& other) const {
      return due != other.due ? due > other.due : number > other.number;  // the earliest is on top
    }
  };
  struct Way {
    int from, to;
    transport::LinkConditions conditions;
    transport::LinkDirection direction;
    std::priority_queue<Packet> waiting = {};
    LineCounts counts = {};
  };

  void TakeIn(Way& way, double now);
  void GiveOut(Way& way, double now);
  [[nodiscard]] double FindNextDue() const;

  std::array<Way, 2> m_ways;  // up, down
  std::uint64_t m_number = 0;
};

}  // namespace wobble::emulator
