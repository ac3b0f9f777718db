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
#include <span>
#include <string>
#include <vector>

#include "client/curve.h"
#include "client/statistics.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"
#include "protocol/patch_model.h"
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

// What the hand holds, until the next SetHand: the vertices of a body round one of them, drawn after the target. The
// server says who may hold what, and from how far away.
struct Hand {
  std::uint32_t body = 0;
  std::uint16_t vertex = 0;
  protocol::Vector3 target;  // of this vertex, m
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
  std::vector<protocol::PatchConstants> patches;    // to decode its shape; without bases for a client that does not
  bool open = false;                                // its faces leave a rim, so that one sees their backs
  std::vector<wire::ParticleTag> particles;         // of the workshop: one a vertex
  std::vector<wire::SpringTag> springs;             // and one an edge
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

using Tuning = protocol::TuningFields;
using Scoreboard = protocol::ScoreboardFields;

// The forces on every stride-th vertex of a body, by kind; a kind that is zero all over is left out.
struct Forces {
  std::uint32_t body = 0;  // 0: none have come yet
  std::uint32_t tick = 0;
  std::uint16_t stride = 1;
  std::vector<protocol::ForceField> fields;
};

// A patch of a body as a record had it, in the order of arrival. Valid only inside the handler.
struct DecodedPatch {
  std::uint32_t body = 0;
  std::uint32_t tick = 0;
  protocol::Pose pose;
  std::span<const protocol::Vector3> shape;  // body frame, m
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
  // nullopt opens the hand. Another body or vertex than before is a new grip.
  void SetHand(const std::optional<Hand>& hand);

  // These ask the server once, and do nothing unless kPlaying. Whether it does it, the world shows; why not, OnNotice.
  // direction: of any length but none.
  void Push(std::uint32_t body, std::uint16_t vertex, const protocol::Vector3& direction);
  // Cuts the springs that pass through the triangle of these points, m.
  void Cut(std::uint32_t body, const protocol::Vector3& eye, const protocol::Vector3& from,
           const protocol::Vector3& to);
  // From now on ReadForces is about this body; 0: no more.
  void Inspect(std::uint32_t body);
  // Units as messages.fbs has them.
  void Tune(wire::TuneKind kind, const protocol::Vector3& value);
  void Build(const protocol::BuildFields& fields);

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

  // As the server said last.
  [[nodiscard]] const Tuning& ReadTuning() const;
  [[nodiscard]] const Scoreboard& ReadScoreboard() const;  // of scenes that have a game
  [[nodiscard]] const Forces& ReadForces() const;          // of the body asked for by Inspect

  // Estimated time of the world on the server, seconds since its tick 0; 0 before the first snapshot. Judged by
  // arrivals alone, so it lags the server's own by the fastest one-way trip seen lately.
  [[nodiscard]] double ServerTime(double now) const;
  // How fast the world goes of what players have asked for, 0 to 1; less than 1: the server has too much to do. Exactly
  // 1 where all goes well.
  [[nodiscard]] double Pace() const;
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
  // Called inside Update with a line for the player: why something was not done.
  void OnNotice(std::function<void(const std::string&)> handler);
  // Called inside Update for each record that has been decoded, for tests that compare clients.
  void OnDecoded(std::function<void(const DecodedPatch&)> handler);
  // Called inside Update for every snapshot packet that counts as one in Statistics and came after the welcome.
  void OnSnapshot(std::function<void(const SnapshotArrival&)> handler);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::client
