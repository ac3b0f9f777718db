// The server's half of a party: its loop as the program has it, and what its ticks cost.
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/server.h"
#include "tests/bench/capacity/contacts.h"
#include "tests/bench/interpolation/truth.h"

namespace wobble::bench {

// That a tick stands for, and may take, s: Config's usual 60 Hz.
inline constexpr double kTickSeconds = 1.0 / 60;

// Of a party. The guests move it on.
enum class Stage : std::uint8_t {
  kGather,  // they come and settle in
  kCount,   // what ticks cost counts
  kShow,    // what is shown is compared with what was; ticks do not count, since keeping that takes time
  kLeave,
  kOver,
};

// What the server counts from its start.
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
  // Of each tick that counts: what the server's thread worked on, and how much time passed meanwhile, s.
  std::vector<server::PhaseTimes> ticks;
  std::vector<double> walls;
  double seconds = 0;  // that counted
  Sums before;
  Sums after;
  server::LoadLevel level = server::LoadLevel::kNormal;  // the highest
  std::size_t bodies = 0;
  Contacts contacts;
  std::vector<double> speeds;  // of bodies when contacts were looked at, m/s
  std::uint64_t awake = 0;     // over those ticks that a call of the server's ended with, as are the next two
  std::uint64_t substeps = 0;
  std::uint64_t allSubsteps = 0;  // with those that were stepped again
  // As it was while shown, of these bodies by their place.
  Truth truth{kTickSeconds};
  std::vector<physics::BodyId> places;
  bool hasAllPlaces = true;  // none has gone since
};

class Host {
 public:
  // server: at 60 Hz, with ReadThreadTime as its clock.
  explicit Host(server::Server& server);

  // By the calling thread, until the party is over.
  void Run(const std::atomic<Stage>& stage);
  // After that.
  [[nodiscard]] Hosted Take() { return std::move(m_hosted); }

 private:
  void Enter(Stage stage);
  void CountTicks(double wall);
  void KeepTruth();

  server::Server& m_server;
  Stage m_stage = Stage::kGather;
  double m_entered = 0;
  std::uint64_t m_removals = 0;  // of the world, when its places were noted
  Hosted m_hosted;
};

}  // namespace wobble::bench
