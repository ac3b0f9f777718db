// The room server/ops watches a server for others: metrics, health, trace, Agones, systemd. This file holds the figures
// that are published, copied out of the server once per call of Tick by the thread that calls it.
#pragma once

#include <array>
#include <cstdint>

#include "server/physics/energy.h"
#include "server/server.h"
#include "server/timing/bins.h"

namespace wobble::ops {

// Bounds of the histograms of tick durations, s. They are dense around 1/60 s, so that one can read off whether ticks
// of 60 Hz fit.
inline constexpr std::array<double, 17> kTickBounds{0.0005, 0.001, 0.002,    0.004, 0.006, 0.008, 0.010, 0.012, 0.014,
                                                    0.015,  0.016, 1.0 / 60, 0.018, 0.020, 0.033, 0.066, 0.25};

// Whether clients may join, and if not, why.
enum class Condition : std::uint8_t { kStarting, kReady, kFull, kBusy, kClosing };

struct Figures {
  Condition condition = Condition::kStarting;
  double told = 0;    // when the figures were copied, s
  std::string scene;  // that is played; empty: none yet

  server::Bins<kTickBounds> tickDurations;
  std::array<server::Bins<kTickBounds>, server::kPhaseCount> phaseDurations;
  std::uint64_t overruns = 0;  // ticks that took longer than their interval
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

// Adds up the energy of all bodies, a part of them per tick so that a round takes a second: all of them in one tick
// would delay it noticeably in a large world.
class EnergyRound {
 public:
  // Call it after each step. tickHz: calls per round. Returns true when a round is complete.
  bool Advance(const physics::World& world, int tickHz);
  // The sum of the last complete round, J.
  [[nodiscard]] const physics::Energy& Last() const { return m_last; }

 private:
  physics::Energy m_last;
  physics::Energy m_sum;
  std::size_t m_next = 0;  // index of the next body
  std::vector<physics::Vector3d> m_scratch;
};

// Copies the figures out of a server.
class Gauge {
 public:
  explicit Gauge(const server::Config& config) : m_config(config) {}
  // Call it after each call of Server::Tick. now: s.
  void Read(const server::Server& server, double now);
  [[nodiscard]] const Figures& ReadFigures() const { return m_figures; }

 private:
  server::Config m_config;
  Figures m_figures;
  EnergyRound m_energy;
};

}  // namespace wobble::ops
