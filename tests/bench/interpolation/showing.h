// A whole game on virtual time whose watchers are compared with the truth: server, four players who run as the fixed
// play has it, and watchers, each behind a link of its own.
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
// In order: clean, 5 % loss with jitter, 20 % loss with much.
[[nodiscard]] const std::vector<NamedLink>& ListLinks();

struct Watcher {
  NamedLink link;
  client::Curve curve = client::Curve::kCatmullRom;
};

// What one watcher was shown, over all frames, bodies and vertices. Errors in % of the radius, RMS.
struct Seen {
  double error = 0;
  double errorP99 = 0;    // 99th percentile of a body's RMS in a frame
  double delay = 0;       // of the moment shown behind the server's own time, the link's trip included, s, mean
  double heldShare = 0;   // of frames and bodies, those with nothing newer in time
  double recordKbit = 0;  // a body's records, kbit/s
  double sentKbit = 0;    // a body's share of the datagrams, all headers counted, kbit/s
  bool disconnected = false;
};

struct Showing {
  std::vector<Seen> watchers;
  double codecError = 0;        // of the records at their ticks, % of the radius, RMS
  double truthErrorOfHalf = 0;  // see Truth, % of the radius
  double speedMedian = 0;       // m/s
};

// Of the vertices that are shown from where they truly were, mean, m².
[[nodiscard]] double FindMeanSquare(const client::BodySample& shown, const std::vector<Vector3d>& vertices);

// seconds: of play that counts, after a few to begin. The play is the same whoever watches.
[[nodiscard]] Showing PlayShowing(int snapshotHz, const std::vector<Watcher>& watchers, std::uint64_t seed,
                                  double seconds);

}  // namespace wobble::bench
