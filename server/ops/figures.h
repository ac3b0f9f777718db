// What a server tells those who watch it, as plain numbers: copied out of it once a tick by the thread that ticks, read
// by whoever is asked for them.
#pragma once

#include <array>
#include <cstdint>

#include "server/physics/energy.h"
#include "server/server.h"
#include "server/timing/bins.h"

namespace wobble::ops {

// Seconds, close together round a sixtieth: whether ticks of 60 Hz fit is what one wants to read off.
inline constexpr std::array<double, 17> kTickBounds{0.0005, 0.001, 0.002,    0.004, 0.006, 0.008, 0.010, 0.012, 0.014,
                                                    0.015,  0.016, 1.0 / 60, 0.018, 0.020, 0.033, 0.066, 0.25};

enum class Condition : std::uint8_t { kStarting, kReady, kFull, kBusy, kClosing };

struct Figures {
  Condition condition = Condition::kStarting;
  double told = 0;  // when these were copied, s

  server::Bins<kTickBounds> tickDurations;
  std::array<server::Bins<kTickBounds>, server::kPhaseCount> phaseDurations;
  std::uint64_t overruns = 0;  // ticks longer than their share of a second
  std::uint64_t droppedTicks = 0;
  double slowedTicks = 0;
  std::uint64_t ticks = 0;  // of the world
  double timeRatio = 1;
  double loadShare = 0;
  server::LoadLevel loadLevel = server::LoadLevel::kNormal;
  int snapshotHz = 0;
  bool isPaused = false;

  server::ClientCounts clients;
  std::size_t maxClients = 0;
  std::size_t bodies = 0;
  physics::StepReport report;  // of the last step
  server::Counts counts;
  server::SendCounts sent;
  std::uint64_t recordsTooLarge = 0;
  transport::Statistics transport;
  physics::Energy energy;  // of the whole world, each body's as of some tick of the last second
};

// Adds up the energy of all bodies, so many a tick that it has been round in a second: all of them in one tick would be
// felt in a large world.
class EnergyRound {
 public:
  // After each step; tickHz: rounds of so many calls. True when a round is complete.
  bool Advance(const physics::World& world, int tickHz);
  [[nodiscard]] const physics::Energy& Last() const { return m_last; }

 private:
  physics::Energy m_last;
  physics::Energy m_sum;
  std::size_t m_next = 0;  // place of the body that is next
  std::vector<physics::Vector3d> m_scratch;
};

// Keeps figures in line with a server.
class Gauge {
 public:
  explicit Gauge(const server::Config& config) : m_config(config) {}
  // After each call of Server::Tick, at `now`, s.
  void Read(const server::Server& server, double now);
  [[nodiscard]] const Figures& ReadFigures() const { return m_figures; }

 private:
  server::Config m_config;
  Figures m_figures;
  EnergyRound m_energy;
};

}  // namespace wobble::ops
