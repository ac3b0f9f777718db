// What observes the ticks of a running server: logs, figures for operators, and the programs that look after it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/admission/refusal_log.h"
#include "server/discovery/announcement.h"
#include "server/discovery/teller.h"
#include "server/ops/agones.h"
#include "server/ops/endpoint.h"
#include "server/ops/fleet_duty.h"
#include "server/ops/service_notices.h"
#include "server/ops/trace.h"
#include "server/program/options.h"
#include "server/server.h"
#include "server/summary.h"

namespace wobble::server {

// Prints a line of figures every few seconds; on a terminal each overwrites the one before.
class StatusLine {
 public:
  // every: s; 0: never.
  explicit StatusLine(double every);

  void Update(const Server& server, const TickTimes& times, double now);
  void Finish() const;

 private:
  double m_every;
  bool m_isTerminal;
  double m_next = 0;
  std::uint64_t m_lastBytes = 0;
};

// All but `times` are optional.
struct Watchers {
  explicit Watchers(const Options& options);

  // Call it after each call of Server::Tick. now: s.
  void Watch(const Server& server, double now);
  // Says when a recording is broken off, and when the state cannot be kept for the first time.
  void WatchFiles(const Server& server);

  std::uint64_t recordingFailures = 0;
  std::uint64_t stateFailures = 0;
  TickTimes times;
  StatusLine status;
  admission::RefusalLog refusals;
  ops::ServiceNotices notices = ops::ServiceNotices::FromEnvironment();
  std::optional<discovery::Teller> teller;
  std::unique_ptr<discovery::Announcement> announcement;
  std::unique_ptr<ops::Endpoint> endpoint;
  ops::Gauge gauge;  // read only while there is an endpoint
  std::optional<ops::Trace> trace;
  std::optional<ops::Agones> agones;
  ops::FleetDuty duty;
  std::vector<ClientId> playing;  // scratch
};

}  // namespace wobble::server
