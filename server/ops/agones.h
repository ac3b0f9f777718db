// A client of Agones that makes the calls of fleet_duty.h over the REST interface of the sidecar beside every game
// server (agones.dev, "REST Game Server Client API").
//
// The calls are made on a thread of their own, so that no tick waits for a sidecar that is dead, silent or slow.
// Agones' own library was rejected: it brings gRPC and Protocol Buffers into the image for six calls.
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

// The name of the counter and of the list of players. The fleet must declare both; the server does not.
inline constexpr const char* kPlayersName = "players";

// Parses the value of AGONES_SDK_HTTP_PORT. Returns nullopt with one line in `error` when it is not 1 to 65535.
[[nodiscard]] std::optional<std::uint16_t> ParseSidecarPort(const std::string& text, std::string& error);

class Agones {
 public:
  struct Counts {
    std::uint64_t succeeded = 0;
    std::uint64_t failed = 0;   // attempts, including those of calls that succeeded later
    std::uint64_t dropped = 0;  // requests lost because the queue was full
  };

  // port: of the sidecar, on the loopback address.
  explicit Agones(std::uint16_t port);
  // Makes the calls that wait for at most a second, then stops.
  ~Agones();
  Agones(const Agones&) = delete;
  Agones& operator=(const Agones&) = delete;

  // Queues calls and returns at once. They are made in this order, except that health goes first, because it alone
  // loses its value by waiting.
  //
  // A call waits 1 s for a connection and 1 s for an answer. A call that found no connection waits for the next
  // Perform, with all calls behind it, because a sidecar may start after its server. So does a ready, allocate or
  // shutdown that got no answer, because repeating it does no harm. Every other failed call is dropped. At most one
  // health call and 1,024 others wait; beyond that, calls that count players are dropped.
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
    int status = 0;       // HTTP status; 0: no answer
    std::string trouble;  // empty: success
  };

  // Stages of the thread:
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

  std::unique_ptr<httplib::Client> m_client;  // used by the thread alone, except for stop()
  mutable std::mutex m_mutex;                 // guards all members below
  std::condition_variable m_changed;
  std::deque<Request> m_waiting;
  bool m_isHealthDue = false;
  bool m_isHeld = false;     // the first request has failed, and all wait for the next Perform
  bool m_isFailing = false;  // the last call failed, and the log has said so
  Stage m_stage = Stage::kRunning;
  Counts m_counts;
  std::thread m_thread;  // last: it uses all other members
};

}  // namespace wobble::ops
