// Plays a whole game on virtual time and compares what watchers see with the truth: a server, four players that run as
// in the fixed play (codec/play.h), and watchers, each behind its own link.
#pragma once

#include <string>
#include <vector>

#include "client/client.h"
#include "protocol/transport/link_conditions.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/report.h"

namespace wobble::bench {

struct NamedLink {
  std::string name;
  transport::LinkConditions conditions;
};
// In order: clean, 5 % loss with jitter, 20 % loss with heavy jitter.
[[nodiscard]] const std::vector<NamedLink>& ListLinks();

struct Watcher {
  NamedLink link;
  client::Curve curve = client::Curve::kCatmullRom;
};

// The quality of what one watcher saw, over all frames, bodies and vertices. Errors are RMS in % of the radius.
struct Seen {
  double error = 0;
  double errorP99 = 0;    // 99th percentile of a body's RMS in a frame
  double delay = 0;       // mean age of the moment shown, measured on the server's clock, s; includes the link's delay
  double heldShare = 0;   // share of (frame, body) pairs for which no newer sample had arrived
  double recordKbit = 0;  // a body's records, kbit/s
  double sentKbit = 0;    // a body's share of the datagrams with all headers, kbit/s
  bool disconnected = false;
};

struct Showing {
  std::vector<Seen> watchers;
  double codecError = 0;        // of the records at their own ticks, % of the radius, RMS
  double truthErrorOfHalf = 0;  // Truth::ErrorOfHalf, % of the radius
  double speedMedian = 0;       // m/s
};

// Mean square distance of the shown vertices from their true positions, m².
[[nodiscard]] double FindMeanSquare(const client::BodySample& shown, const std::vector<Vector3d>& vertices);

// Plays a game. seconds: measured play, after a warm-up of a few seconds. The play does not depend on the watchers.
[[nodiscard]] Showing PlayShowing(int snapshotHz, const std::vector<Watcher>& watchers, std::uint64_t seed,
                                  double seconds);

}  // namespace wobble::bench
