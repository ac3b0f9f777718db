// A client of Agones: keeps the record that Agones has of this server as fleet_duty.h wishes it, by the calls of
// fleet_reconciler.h, over the REST interface of the sidecar beside every game server.
//
// The calls are made one at a time on a thread of their own, so that no tick waits for a sidecar that is dead, silent
// or slow. Agones' own library was rejected: it brings gRPC and Protocol Buffers into the image for seven calls.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/ops/fleet_duty.h"
#include "server/ops/fleet_reconciler.h"

namespace httplib {
class Client;
}

namespace wobble::ops {

// Parses the value of AGONES_SDK_HTTP_PORT. Returns nullopt with one line in `error` when it is not 1 to 65535.
[[nodiscard]] std::optional<std::uint16_t> ParseSidecarPort(const std::string& text, std::string& error);

class Agones {
 public:
  struct Counts {
    std::uint64_t succeeded = 0;    // calls
    std::uint64_t failed = 0;       // calls
    std::uint64_t corrections = 0;  // times the record had lost what had been set
  };

  // port: of the sidecar, on the loopback address.
  explicit Agones(std::uint16_t port);
  // Makes the calls that are due for at most a second, then stops.
  ~Agones();
  Agones(const Agones&) = delete;
  Agones& operator=(const Agones&) = delete;

  // What is to be from now on. Returns at once. A call waits 1 s for a connection and 1 s for an answer; whatever
  // becomes of it, the record is brought to the last wish when the sidecar answers again.
  void Want(const FleetWish& wish);

  [[nodiscard]] Counts ReadCounts() const;

 private:
  struct Outcome {
    FleetAnswer answer;
    std::string trouble;  // empty: success
  };

  // Stages of the thread:
  //   kRunning    makes the calls that are due, and waits for more
  //   kEnding     the destructor has begun: makes the calls that are due
  //   kBrokenOff  a second has passed since: the call under way is stopped, and none is begun
  //   kDone       the thread has left its loop
  // Only forwards; from kEnding straight to kDone when no call is due in time.
  enum class Stage : std::uint8_t { kRunning, kEnding, kBrokenOff, kDone };

  void Work();
  [[nodiscard]] Outcome Send(const FleetCall& call);
  void Log(const FleetCall& call, const std::string& trouble, const std::string& news);

  // Used by the thread alone, except for the client's stop().
  std::unique_ptr<httplib::Client> m_client;
  FleetReconciler m_reconciler;
  std::array<std::string, FleetCall::kKinds> m_troubles;  // that the log has, by kind of call

  mutable std::mutex m_mutex;  // guards all members below
  std::condition_variable m_changed;
  FleetWish m_wish;
  Stage m_stage = Stage::kRunning;
  Counts m_counts;
  std::thread m_thread;  // last: it uses all other members
};

}  // namespace wobble::ops
