// The client library, which players embed: joins a world, sends the player's input, and knows where every body is.
//
// It decodes and interpolates; nothing is simulated here. Time is a parameter and the network is the Transport that it
// is given, so it runs the same over ENet, over a WebSocket and over a seeded link in tests. For one thread: no
// function may be called while another one runs.
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
#include "protocol/codec/patch_model.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"
#include "protocol/transport/transport.h"

namespace wobble::client {

// A blueprint from an earlier connection, as Options::keep got it.
struct KeptBlueprint {
  std::uint64_t hash = 0;
  std::vector<std::uint8_t> bytes;
};
using KeptBlueprints = std::vector<KeptBlueprint>;

struct Options {
  std::string name = "player";  // at most protocol::kMaxNameBytes bytes of UTF-8
  bool spectator = false;       // sees the world but has no body
  bool isBot = false;           // no person plays: games do not wait for it, and do not count what bots win alone
  bool decode = true;           // false: reads poses only, no shapes (for load tests); Sample then shows nothing
  // Shows the own body ahead of the others by what inputs will do that no record has in it yet; see BodySample::lead.
  bool predict = true;
  Curve curve = Curve::kCatmullRom;
  // Blueprints that the server need not send again; may be null. Of more than protocol::kMaxKeptBlueprints or
  // kMaxKeptBytes the first count.
  std::shared_ptr<const KeptBlueprints> kept = {};
  // Called inside Update with each blueprint that was downloaded and is large enough to be kept for later connections.
  // May be empty. files/kept_folder.h sets both, and keeps blueprints in files.
  std::function<void(std::uint64_t hash, std::span<const std::uint8_t> bytes)> keep = {};
  // The most of a blueprint's bases that one Update completes, multiplications; 15 million take 7 ms. A ball needs 45
  // million until it can be shown. A program that draws and does not call Update in a thread of its own may take less,
  // and call Update again while IsCompleting and the frame has time.
  std::size_t completionWork = 15'000'000;
  std::uint16_t protocolVersion = protocol::kProtocolVersion;  // sent in the hello; other values are for tests
};

// The player's input, which holds until the next SetInput.
struct Input {
  float moveX = 0;  // along the world's x, -1..1
  float moveY = 0;  // along the world's y, -1..1
  bool jump = false;
  bool puff = false;
  bool stiffen = false;
};

// The grip of the hand until the next SetHand: the vertices of a body around `vertex`, pulled so that it follows the
// target. The server decides which bodies may be held, and from how far away.
struct Hand {
  std::uint32_t body = 0;
  std::uint16_t vertex = 0;
  protocol::Vector3 target;  // for this vertex, world, m
};

enum class State {
  kConnecting,  // the server has not answered yet
  // Hello sent; the welcome, the own body's blueprint or heights are still to come. Again whenever another scene
  // begins.
  kJoining,
  kPlaying,
  kEnded,  // see EndReason
};

// Shared by all bodies made from it.
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

// Ground as heights over a grid. Triangles between them are close to the server's true surface. Solid below; there is
// nothing beyond the grid.
struct Ground {
  protocol::Vector3 corner;    // x and y of the first height, metres; z is included in the heights
  float cellSize = 1;          // metres
  int columns = 0;             // along x, at least 2
  int rows = 0;                // along y, at least 2
  std::vector<float> heights;  // metres, row by row, x running fastest
};

// One body as it is to be shown at a moment.
struct BodySample {
  std::uint32_t body = 0;
  std::shared_ptr<const Blueprint> blueprint;
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;  // world, metres; empty for kPosesOnly
  // How far the own body is shown from where its records have it, metres; in pose and vertices already. Else 0.
  protocol::Vector3 lead;
  double age = 0;     // seconds of world time from the newest record used to the newest tick known
  bool held = false;  // no record arrived in time: shown as it was last
};
enum class Detail { kPosesOnly, kVertices };

// The newest received pose of a body, neither delayed nor interpolated.
struct Sighting {
  std::uint32_t body = 0;
  protocol::Pose pose;
  // Mean velocity between the two newest poses, metres per second of world time. nullopt when there is only one, when
  // they are further apart than kMaxVelocitySpan, and when the body respawned between them.
  std::optional<protocol::Vector3> velocity;
  double age = 0;  // seconds of world time from the pose to the newest tick known
};

using Tuning = protocol::TuningFields;
using Scoreboard = protocol::ScoreboardFields;

// The forces on every stride-th vertex of a body, by kind; a kind that is zero everywhere is left out.
struct Forces {
  std::uint32_t body = 0;  // 0: none received yet
  std::uint32_t tick = 0;
  std::uint16_t stride = 1;
  std::vector<protocol::ForceField> fields;
};

// A decoded record: one patch of a body, in the order of arrival. Valid only inside the handler.
struct DecodedPatch {
  std::uint32_t body = 0;
  std::uint32_t tick = 0;
  protocol::Pose pose;
  std::span<const protocol::Vector3> shape;  // body frame, m
};

// Measurements of the link from the arrival of one snapshot packet. Seconds.
struct SnapshotArrival {
  std::uint32_t tick = 0;
  // Time from the packet's tick to its arrival: how much later it came than the fastest packet of the last half minute,
  // plus that packet's trip. The trip cannot be measured from one end; half of the smallest inputToSnapshot of the last
  // half minute is taken for it, less half a tick: an input waits for up to a tick before it is used. So it is true to
  // a quarter of a tick where both ways take equally long.
  double age = 0;
  // Time from first sending an input to this packet, when it is the first of a world that has used the input; else -1.
  double inputToSnapshot = -1;
};

// The longest that Leave can take, seconds.
inline constexpr double kLongestLeave = 5;

class Client {
 public:
  // transport: one that is already connecting to the server. now: seconds since any fixed moment, never backwards, in
  // all functions.
  Client(std::unique_ptr<transport::Transport> transport, Options options, double now);
  ~Client();

  // Takes in what has arrived, answers, and sends the input that is due. To be called at least once a tick, also while
  // leaving.
  void Update(double now);

  // Sent with the next Update.
  void SetInput(const Input& input);
  // As Options::predict, from the next Sample on.
  void SetPredicts(bool predicts);
  // nullopt opens the hand. Another body or vertex than before begins a new grip.
  void SetHand(const std::optional<Hand>& hand);

  // Commands: each is sent to the server once, and only while kPlaying. The world shows whether the server obeys;
  // OnNotice says why it does not.
  //
  // Pushes the vertices around this one. direction: world, of any length but 0.
  void Push(std::uint32_t body, std::uint16_t vertex, const protocol::Vector3& direction);
  // Cuts the springs of the body that pass through the triangle of these points, world, m.
  void Cut(std::uint32_t body, const protocol::Vector3& eye, const protocol::Vector3& from,
           const protocol::Vector3& to);
  // From now on ReadForces is about this body; 0: about none.
  void Inspect(std::uint32_t body);
  // Says a line to everybody, of at most protocol::kMaxSaidBytes; more is cut. A player may say one a second, and four
  // at once.
  void Say(const std::string& text);
  // Shows a sign over the own body for some seconds; it counts as a line does.
  void Emote(wire::EmoteKind kind);
  // Another name, of at most protocol::kMaxNameBytes, from now on and for a hello to come. An event tells when it is in
  // force, and how it reads: the server makes it differ from those of others.
  void Rename(const std::string& name);
  // A line to the server's administration, such as a moderator's "kick 7" or a player's "vote restart"; at most
  // protocol::kMaxOrderBytes. The answer comes as notices.
  void Order(const std::string& line);
  // Sets gravity, stiffness, time rate, or jumps ahead; units as in messages.fbs.
  void Tune(wire::TuneKind kind, const protocol::Vector3& value);
  // Changes the body that players build together; units as in messages.fbs.
  void Build(const protocol::BuildFields& fields);

  // Says goodbye. The state becomes kEnded once the server or the link has closed: after a second of Updates plus four
  // round trips at the latest, and never later than kLongestLeave.
  void Leave(double now);

  [[nodiscard]] State ReadState() const;
  // One line for people; empty while not ended, "left" after Leave.
  [[nodiscard]] const std::string& EndReason() const;
  // True when it has ended without a Leave.
  [[nodiscard]] bool EndedUnasked() const;

  // True when it has ended because somebody in charge kicked or banned this client.
  [[nodiscard]] bool WasSentAway() const;

  // Whether a new connection may fare better than the one that has ended: it was lost, or the server was restarted, was
  // closing, full or busy. False after Leave, where the server does not want this client, and over a link too poor.
  // lasting_client.h joins again by itself.
  [[nodiscard]] bool MayRejoin() const;

  // Whether blueprints have come whose bases are not complete.
  [[nodiscard]] bool IsCompleting() const;

  // Complete from kPlaying on. A server with several scenes goes from one to the next on the same connection: then all
  // of this is of another world, with other bodies under the same numbers. OnNextScene tells when.
  [[nodiscard]] const protocol::WelcomeFields& Welcome() const;
  [[nodiscard]] const std::vector<Ground>& Grounds() const;
  [[nodiscard]] const Statistics& ReadStatistics() const;

  // As the server sent them last.
  [[nodiscard]] const Tuning& ReadTuning() const;
  [[nodiscard]] const Scoreboard& ReadScoreboard() const;  // of scenes that have a game
  [[nodiscard]] const Forces& ReadForces() const;          // of the body that Inspect named

  // Estimated world time on the server, seconds since its tick 0; 0 before the first snapshot. Estimated from arrivals
  // alone, so it lags the server's own by the fastest recent one-way trip.
  [[nodiscard]] double ServerTime(double now) const;
  // The world's speed as a share of the time rate that is tuned, 0 to 1: less than 1 when the server is overloaded,
  // exactly 1 otherwise.
  [[nodiscard]] double Pace() const;
  // How far behind ServerTime bodies are shown, seconds; grows with jitter.
  [[nodiscard]] double InterpolationDelay() const;

  // All bodies as they are to be shown at `now`, by ascending body. `samples` is overwritten; pass the same vector
  // again to save allocations.
  void Sample(double now, Detail detail, std::vector<BodySample>& samples);
  // A body's newest received pose, without delay, for bots; nullopt when none is known.
  [[nodiscard]] std::optional<protocol::Pose> NewestPose(std::uint32_t body) const;
  // The vertex of the body that was nearest to the place, world, m, in its rest shape at its newest pose; nullopt when
  // its pose or blueprint is not known.
  [[nodiscard]] std::optional<std::uint16_t> FindVertex(std::uint32_t body, const protocol::Vector3& place) const;
  // The same as NewestPose, with velocity and age.
  [[nodiscard]] std::optional<Sighting> FindSighting(std::uint32_t body) const;
  // The same for all bodies, in no order. `sightings` is overwritten and its memory reused.
  void ListSightings(std::vector<Sighting>& sightings) const;

  struct Event {
    wire::EventKind kind;
    std::uint32_t clientId = 0;
    std::uint32_t body = 0;
    std::string name;                               // of Said: the line
    wire::EmoteKind emote = wire::EmoteKind::Wave;  // of Emote
  };
  // Handlers are called inside Update.
  //
  // For every event of the server.
  void OnEvent(std::function<void(const Event&)> handler);
  // With the name of the scene that begins now. All that was of the scene before is gone: the bodies, the welcome, who
  // is in. Events say once more who is in; the next welcome is complete when the client plays again.
  void OnNextScene(std::function<void(const std::string& scene)> handler);
  // With a line for the player: why a command was not obeyed.
  void OnNotice(std::function<void(const std::string&)> handler);
  // For each record that has been decoded; for tests that compare clients.
  void OnDecoded(std::function<void(const DecodedPatch&)> handler);
  // For every snapshot packet that is counted in Statistics::snapshots and came after the welcome, before its records
  // are decoded.
  void OnSnapshot(std::function<void(const SnapshotArrival&)> handler);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::client
