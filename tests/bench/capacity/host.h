// The server of a party: the same loop as in wobbled, with measurements of its ticks.
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/server.h"
#include "tests/bench/capacity/contacts.h"
#include "tests/bench/interpolation/truth.h"

namespace wobble::bench {

// Duration of a tick, and the time that it may take, s: 60 Hz, the default of Config.
inline constexpr double kTickSeconds = 1.0 / 60;

// Stages of a party, in order. Guests advances them; Host only reads them.
enum class Stage : std::uint8_t {
  kGather,  // players join and settle
  kCount,   // the cost of ticks is measured
  kShow,    // shown bodies are compared with the truth; ticks are not measured, because recording the truth takes time
  kLeave,
  kOver,
};

// Counters of the server since its start.
struct Sums {
  std::uint64_t ticks = 0;
  std::uint64_t packets = 0;   // snapshots
  std::uint64_t bytes = 0;     // payloads of all datagrams
  std::uint64_t vertices = 0;  // in records
  double errorSquares = 0;     // SendCounts
  std::uint64_t leftOut = 0;
  std::uint64_t dropped = 0;  // ticks
  std::uint64_t quarantined = 0;
};

struct Hosted {
  // Per measured tick: thread time of each phase, and wall time, s.
  std::vector<server::PhaseTimes> ticks;
  std::vector<double> walls;
  double seconds = 0;           // measured
  std::uint32_t worstTick = 0;  // of the world, the longest one measured
  Sums before;
  Sums after;
  server::LoadLevel level = server::LoadLevel::kNormal;  // the highest reached
  std::size_t bodies = 0;
  Contacts contacts;
  std::vector<double> speeds;  // of bodies, whenever contacts were counted, m/s
  std::uint64_t awake = 0;     // summed over the last tick of each call of the server, like the next two
  std::uint64_t substeps = 0;
  std::uint64_t allSubsteps = 0;  // repeated substeps included
  // The truth in stage kShow, of the bodies in `places`.
  Truth truth{kTickSeconds};
  std::vector<physics::BodyId> places;
  bool hasAllPlaces = true;  // no body has been removed since
};

class Host {
 public:
  // server: runs at 60 Hz with ReadThreadTime as its clock.
  explicit Host(server::Server& server);

  // Runs the server in the calling thread until the stage is kOver.
  void Run(const std::atomic<Stage>& stage);
  // The result; call it after Run.
  [[nodiscard]] Hosted Take() { return std::move(m_hosted); }

 private:
  void Enter(Stage stage);
  void CountTicks(double wall);
  void KeepTruth();

  server::Server& m_server;
  Stage m_stage = Stage::kGather;
  double m_entered = 0;
  double m_longest = 0;          // s, of worstTick
  std::uint64_t m_removals = 0;  // of the world, when `places` was filled
  Hosted m_hosted;
};

}  // namespace wobble::bench
