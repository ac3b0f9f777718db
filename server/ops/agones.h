// Makes the calls of fleet_duty.h to Agones: a small client of the REST interface that its sidecar offers beside every
// game server (agones.dev, "REST Game Server Client API").
//
// One thread of its own, so that no tick ever waits for a sidecar that is dead, silent or slow. Agones' own library was
// not taken: it brings gRPC and Protocol Buffers into the image for six calls.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "server/ops/fleet_duty.h"

namespace httplib {
class Client;
}

namespace wobble::ops {

// A counter and a list of this name have to be declared for the fleet; wobble declares none itself.
inline constexpr const char* kPlayersName = "players";

// The value of AGONES_SDK_HTTP_PORT. None with one line in `error` when it is no number from 1 to 65535.
[[nodiscard]] std::optional<std::uint16_t> ParseSidecarPort(const std::string& text, std::string& error);

class Agones {
 public:
  struct Counts {
    std::uint64_t succeeded = 0;
    std::uint64_t failed = 0;   // tries, also of calls that succeeded later
    std::uint64_t dropped = 0;  // requests that found the queue full
  };

  // port: of the sidecar, on this machine.
  explicit Agones(std::uint16_t port);
  // Goes on with what waits for a second at most; then breaks off.
  ~Agones();
  Agones(const Agones&) = delete;
  Agones& operator=(const Agones&) = delete;

  // Returns at once. They are made in this order, but for health, which overtakes: it alone is late when it waits.
  //
  // Calls wait 1 s for a connection and 1 s for an answer. What could not be connected waits for the next Perform, and
  // all behind it, for a sidecar may start after its server; so does a ready, allocate or shutdown that got no answer,
  // as it does no harm twice. Every other call that failed is gone. One health call waits at most, and a thousand
  // others: beyond that, players are no longer counted.
  void Perform(std::span<const FleetCall> calls);

  [[nodiscard]] Counts ReadCounts() const;

 private:
  struct Request {
    FleetCall::Kind kind{};
    const char* method = "POST";
    std::string path;
    std::string body = "{}";
  };
  struct Outcome {
    bool isConnected = false;
    int status = 0;       // of HTTP; 0: no answer
    std::string trouble;  // empty: it succeeded
  };

  // Of the thread:
  //   kRunning    makes the calls that are queued, and waits for more
  //   kEnding     the destructor has begun: makes the calls that are left
  //   kBrokenOff  a second has passed since: the call under way is stopped, and none is begun
  //   kDone       the thread has left its loop
  // Only forwards; from kEnding straight to kDone when the queue is empty in time.
  enum class Stage : std::uint8_t { kRunning, kEnding, kBrokenOff, kDone };

  void Queue(const FleetCall& call);
  void Add(Request request);
  void Work();
  [[nodiscard]] bool HasNext() const;
  [[nodiscard]] Request TakeNext();
  [[nodiscard]] Outcome Send(const Request& request);
  void Note(Request request, const Outcome& outcome);

  std::unique_ptr<httplib::Client> m_client;  // the thread's, but for its stop()
  mutable std::mutex m_mutex;                 // of all below
  std::condition_variable m_changed;
  std::deque<Request> m_waiting;
  bool m_isHealthDue = false;
  bool m_isHeld = false;     // the first request has failed, and all wait for the next Perform
  bool m_isFailing = false;  // the last call failed, and the log has said so
  Stage m_stage = Stage::kRunning;
  Counts m_counts;
  std::thread m_thread;  // the last, for it uses all of them
};

}  // namespace wobble::ops
