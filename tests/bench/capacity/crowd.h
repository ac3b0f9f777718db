// A crowd on virtual time, without sockets: a server and bots that play the report's script. The game is the same to
// the bit for any number of threads, so that one run can be compared with another tick by tick.
#pragma once

#include <functional>
#include <vector>

#include "client/bots/runner.h"
#include "protocol/transport/link_conditions.h"
#include "protocol/transport/virtual_network.h"
#include "server/server.h"
#include "tests/bench/capacity/party.h"

namespace wobble::bench {

struct CrowdOptions {
  unsigned players = 128;
  int threads = 1;
  double clientKbit = kClientKbit;
  transport::LinkConditions link = {};  // both ways
};

class Crowd {
 public:
  // game, script: outlive this object; script: has been loaded and is of this crowd alone.
  Crowd(const Game& game, const CrowdOptions& options, bots::Script& script);

  // Plays on until `until`, s. onTick: called after each tick with the wall time that the server took for it, s; may be
  // empty.
  using OnTick = std::function<void(double seconds)>;
  void Play(double until, const OnTick& onTick = {});
  // Called in each round of a bot that decodes (one in 32), with what its player sees.
  void SetOnShown(bots::Runner::OnShown onShown) { m_runner.SetOnShown(std::move(onShown)); }

  [[nodiscard]] const server::Server& Server() const { return m_server; }
  [[nodiscard]] unsigned CountPlaying() const { return static_cast<unsigned>(m_server.CountPlaying()); }

 private:
  void PlayTick(double now, const OnTick& onTick);

  transport::VirtualNetwork m_network;
  server::Server m_server;
  bots::Runner m_runner;
  double m_nextRound = 0;  // s
};

// What snapshots between two moments took of the links, kbit with all headers.
[[nodiscard]] double FindSnapshotKbit(const server::SendCounts& before, const server::SendCounts& after);

}  // namespace wobble::bench
