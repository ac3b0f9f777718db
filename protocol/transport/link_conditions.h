// What a bad network does to datagrams, and how people write it down.
//
// Shared by the virtual network of the tests and the relay between real sockets.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::transport {

// Every `period` seconds the link is black for the last `length` of them, so that it begins clear. length 0: never.
struct Blackout {
  double length = 0;
  double period = 0;
};

// One direction. Shares are 0..1, times seconds, 0..10 unless said otherwise.
struct LinkConditions {
  double loss = 0;             // share of datagrams that never arrive
  double delay = 0;            // one way
  double jitter = 0;           // added to the delay, uniform in 0..jitter
  double duplicate = 0;        // share of datagrams that arrive twice, each with its own jitter
  double reorder = 0;          // share held back by reorderDelay, on top of what jitter reorders
  double reorderDelay = 0.05;  // a frame and a half at 30 Hz
  double rate = 0;             // bit/s, kMinRate..kMaxRate, the headers of IP and UDP included; 0: no limit
  Blackout blackout{};         // length 0..60, period above it and 0.1..3,600
};
inline constexpr double kMinRate = 1e3;
inline constexpr double kMaxRate = 1e10;

// One line for each field out of its range, with value and range; empty when all are good.
[[nodiscard]] std::vector<std::string> ValidateLinkConditions(const LinkConditions& conditions);

// Whether the link is black at this moment; time: seconds since the link began, 0 or more.
[[nodiscard]] bool IsBlack(const Blackout& blackout, double time);

// Both directions of a link, seen from the client: up is what it sends.
struct LinkSpec {
  LinkConditions up;
  LinkConditions down;
};

// 'loss=5%,delay=50ms,jitter=20ms,duplicate=1%,reorder=2%,rate=512kbit,blackout=250ms/15s', each at most once and all
// of them optional. It holds for both directions; 'up.loss=...' or 'down.rate=...' for one, and before the one without.
// Shares in %, times in ms or s, rates in bit, kbit or mbit (per second). nullopt with one line in `error`: the field,
// what was written, what is allowed.
[[nodiscard]] std::optional<LinkSpec> ParseLinkSpec(std::string_view text, std::string& error);

}  // namespace wobble::transport
