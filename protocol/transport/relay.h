// A seeded bad network between real sockets: a UDP relay that players connect to instead of the server.
//
// It works below ENet: any client, also one over a gateway, plays through it unchanged. Each source address gets an
// upstream socket of its own, so the server sees a different address for each player, too.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "protocol/transport/link_conditions.h"

namespace wobble::transport {

struct RelayOptions {
  std::uint16_t port = 0;        // UDP, to listen on; 0: the system picks a free one
  std::string host = "0.0.0.0";  // numeric IPv4 address of this machine to listen at
  std::string serverHost;
  std::uint16_t serverPort = 0;
  LinkSpec link;  // valid
  std::uint64_t seed = 1;
  std::size_t maxClients = 4096;  // source addresses at once; datagrams of further ones are dropped
  double idleTimeout = 60;        // seconds without a datagram until a source address is forgotten
};

// Datagrams of one direction, all clients together, since the relay was opened. Each that was received is, once its
// delay is over, either passed (once or twice) or counted in one of lost ... unsent.
struct RelayDirectionCounts {
  std::uint64_t received = 0;
  std::uint64_t passed = 0;  // copies included
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;   // held back
  std::uint64_t overRate = 0;    // the queue before the limited rate was full
  std::uint64_t blackedOut = 0;  // entered or would have come out during a black-out
  std::uint64_t unsent = 0;      // copies that the system did not take, or beyond the bytes that may wait
  std::uint64_t bytesIn = 0;     // payloads
  std::uint64_t bytesOut = 0;
};

// How late datagrams left, by the clock of the caller of Run.
class Lateness {
 public:
  void Add(double seconds);
  // The upper edge, ms, of the bucket of 0.1 ms in which that share lies; 10 for all beyond, 0 when nothing was added.
  [[nodiscard]] double FindPercentileMs(double share) const;

 private:
  std::array<std::uint64_t, 100> m_buckets{};
  std::uint64_t m_count = 0;
};

struct RelayCounts {
  RelayDirectionCounts up;  // to the server
  RelayDirectionCounts down;
  std::size_t clients = 0;           // now
  std::uint64_t clientsEver = 0;     // source addresses seen
  std::uint64_t clientsRefused = 0;  // datagrams of addresses over maxClients or without an upstream socket
  Lateness lateness;
};

class Relay {
 public:
  // Resolves the server's name (which may block) and binds the port. Null with one line in `error` when either fails,
  // or the address to listen at is none.
  [[nodiscard]] static std::unique_ptr<Relay> Open(const RelayOptions& options, std::string& error);
  ~Relay();

  // Sends datagrams that are due and takes in those that have arrived, a limited number; false when there are more.
  // now: seconds, never backwards; black-outs are counted from the first call.
  bool Run(double now);

  // When the next datagram is due; infinity when none waits.
  [[nodiscard]] double NextDue() const;
  // Waits until a datagram arrives, at most for so many seconds (to the nanosecond, as far as the system can).
  void Wait(double seconds) const;

  [[nodiscard]] std::uint16_t ReadPort() const;
  [[nodiscard]] const RelayCounts& ReadCounts() const;

 private:
  struct Impl;
  explicit Relay(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> m_impl;
};

}  // namespace wobble::transport
