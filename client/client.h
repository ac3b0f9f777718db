// The client library: joins a world, sends what its player asks for, and knows where every body is right now.
//
// Thin by design: it decodes and interpolates, nothing is simulated here. Time is a parameter, the network is whatever
// Transport it is given, so it runs alike over ENet, over a WebSocket and over a seeded link in tests. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/curve.h"
#include "client/statistics.h"
#include "protocol/basis.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"
#include "protocol/transport/transport.h"

namespace wobble::client {

struct Options {
  std::string name = "player";  // at most protocol::kMaxNameBytes bytes
  bool spectator = false;       // sees the world but has no body
  bool decode = true;           // false: reads heads only (for load tests): where bodies are, not how they look
  Curve curve = Curve::kCatmullRom;
  std::uint16_t protocolVersion = protocol::kProtocolVersion;  // said in hello; another one is for testing servers
};

// What the player asks for, until the next SetInput. move: right and forward in the horizontal plane, each -1..1.
struct Input {
  float moveX = 0;
  float moveY = 0;
  bool jump = false;
  bool puff = false;
  bool stiffen = false;
};

enum class State {
  kConnecting,  // no answer from the server yet
  kJoining,     // hello sent, welcome or blueprints still to come
  kPlaying,
  kEnded,  // see EndReason()
};

// Shared by all bodies made from it; kept for as long as anything names it.
struct Blueprint {
  std::string name;
  std::vector<protocol::Vector3> rest;              // body frame, metres
  std::vector<std::array<std::uint16_t, 3>> faces;  // outward
  float size = 0;                                   // RMS distance of the rest vertices from their centroid, metres
  std::vector<std::array<std::uint16_t, 2>> edges;  // springs of a body without faces; a vertex may be in none
  std::vector<std::shared_ptr<const protocol::Basis>> bases;  // of its patches, to decode them; or none
  bool open = false;                                          // its faces leave a rim, so that one sees their backs
};

// Ground as heights over a grid, row by row, x first; near enough to the true surface with triangles in between. Solid
// below, nothing beyond.
struct Ground {
  protocol::Vector3 corner;    // x and y of the first height, metres; z is in the heights already
  float cellSize = 1;          // metres
  int columns = 0;             // along x, at least 2
  int rows = 0;                // along y, at least 2
  std::vector<float> heights;  // metres
};

// One body at one moment.
struct BodySample {
  std::uint32_t body = 0;
  std::shared_ptr<const Blueprint> blueprint;
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;  // in the world, metres; empty for PosesOnly
  double age = 0;                           // of the newest record used, server seconds behind the newest tick known
  bool held = false;                        // nothing newer arrived in time: shown as it was last
};
enum class Detail { kPosesOnly, kVertices };

// Where a body was when it was last heard of: neither delayed nor interpolated.
struct Sighting {
  std::uint32_t body = 0;
  protocol::Pose pose;
  // Mean between the two newest poses, metres per second of world time; nullopt when there is one only, when they lie
  // too far apart to tell (kMaxVelocitySpan), and when the body was put elsewhere between them.
  std::optional<protocol::Vector3> velocity;
  double age = 0;  // of the pose, server seconds behind the newest tick known
};

// What one snapshot packet says about the link. Seconds.
struct SnapshotArrival {
  std::uint32_t tick = 0;
  // Arrival minus the moment of its tick: how much later it came than the fastest of the last half minute, plus that
  // one's trip. The latter cannot be measured from one end; taken for it is half of the smallest inputToSnapshot so far
  // less a tick (an input waits up to a tick before it is used).
  double age = 0;
  // From first sending an input to this packet, the first that shows a world which has used it; -1 in any other.
  double inputToSnapshot = -1;
};

// Seconds.
inline constexpr double kLongestLeave = 5;

class Client {
 public:
  // The transport is one that is connecting to the server already.
  Client(std::unique_ptr<transport::Transport> transport, Options options, double now);
  ~Client();

  // Takes in what has arrived, answers, and sends the input that is due. Call it at least once a tick; `now` in
  // seconds, never backwards.
  void Update(double now);

  void SetInput(const Input& input);

  // Says goodbye. State is kEnded once the server or the link has closed, at the latest after a second of Updates and
  // four round trips, which is never more than kLongestLeave.
  void Leave(double now);

  [[nodiscard]] State ReadState() const;
  // One line for people; empty while not ended, and "left" after an own Leave.
  [[nodiscard]] const std::string& EndReason() const;
  // True when it ended in any other way than by Leave.
  [[nodiscard]] bool EndedUnasked() const;

  // Set while kPlaying and after.
  [[nodiscard]] const protocol::WelcomeFields& Welcome() const;
  [[nodiscard]] const std::vector<Ground>& Grounds() const;
  [[nodiscard]] const Statistics& ReadStatistics() const;

  // Estimated time of the world on the server, seconds since its tick 0; 0 before the first snapshot. Judged by
  // arrivals alone, so it lags the server's own by the fastest one-way trip seen lately.
  [[nodiscard]] double ServerTime(double now) const;
  // How far behind ServerTime bodies are shown, seconds: grows with jitter.
  [[nodiscard]] double InterpolationDelay() const;

  // All bodies as they are to be shown at `now`, by ascending body; `samples` is reused to save allocations.
  void Sample(double now, Detail detail, std::vector<BodySample>& samples);
  // A body's newest received pose without delay, for bots; nullopt before anything is known of it.
  [[nodiscard]] std::optional<protocol::Pose> NewestPose(std::uint32_t body) const;
  [[nodiscard]] std::optional<Sighting> FindSighting(std::uint32_t body) const;
  // The same of all bodies, in no order; `sightings` is reused to save allocations.
  void ListSightings(std::vector<Sighting>& sightings) const;

  struct Event {
    wire::EventKind kind;
    std::uint32_t clientId = 0;
    std::uint32_t body = 0;
    std::string name;
  };
  // Called inside Update for every event of the server.
  void OnEvent(std::function<void(const Event&)> handler);
  // Called inside Update for every snapshot packet that counts as one in Statistics and came after the welcome.
  void OnSnapshot(std::function<void(const SnapshotArrival&)> handler);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::client
