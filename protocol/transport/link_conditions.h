// The conditions of a bad network, and the text form of them.
//
// Used by the virtual network of the tests and by the relay between real sockets.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::transport {

// A black-out: nothing passes during the last `length` of every `period` seconds, so a link begins clear. length 0:
// never.
struct Blackout {
  double length = 0;
  double period = 0;
};

// The conditions in one direction. Shares are 0..1; times are seconds, 0..10 unless said otherwise.
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

// One line for each field out of its range, with the value and the range; empty when all are valid.
[[nodiscard]] std::vector<std::string> ValidateLinkConditions(const LinkConditions& conditions);

// Whether the link is black at this moment; time: seconds since the link began, 0 or more.
[[nodiscard]] bool IsBlack(const Blackout& blackout, double time);

// Both directions of a link; `up` is what the client sends.
struct LinkSpec {
  LinkConditions up;
  LinkConditions down;
};

// Reads 'loss=5%,delay=50ms,jitter=20ms,duplicate=1%,reorder=2%,rate=512kbit,blackout=250ms/15s': each field at most
// once, all optional. A field holds for both directions; with 'up.' or 'down.' before it for that one, where it takes
// precedence. Shares in %, times in ms or s, rates in bit, kbit or mbit (per second). nullopt with one line in `error`:
// the field, the text, the range.
[[nodiscard]] std::optional<LinkSpec> ParseLinkSpec(std::string_view text, std::string& error);

}  // namespace wobble::transport
