// The server: a world, its clients, and the tick that joins them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "protocol/transport/transport.h"
#include "server/config.h"
#include "server/physics/world.h"
#include "server/play/hands.h"
#include "server/play/sumo.h"
#include "server/play/tuning.h"
#include "server/play/workshop.h"
#include "server/scenes/scene.h"
#include "server/session.h"
#include "server/snapshots/capture.h"
#include "server/snapshots/encoder.h"
#include "server/snapshots/snapshot_sender.h"
#include "server/timing/load.h"
#include "server/timing/phases.h"
#include "server/timing/tick_clock.h"
#include "server/training/basis_training.h"

namespace wobble::server {

inline constexpr std::size_t kGoodbyeReasonCount = static_cast<std::size_t>(protocol::wire::GoodbyeReason::MAX) + 1;

// Since the start. What a person hosting wants to know; summary.h writes it out.
struct Counts {
  std::uint64_t substeps = 0;
  std::uint64_t awakeSum = 0;  // over ticks
  std::uint64_t nonFinite = 0;
  std::uint64_t inverted = 0;
  std::uint64_t quarantined = 0;
  std::uint64_t reset = 0;
  std::uint64_t torn = 0;  // springs
  std::uint64_t respawns = 0;
  double pausedTime = 0;  // s
  std::uint64_t joins = 0;
  std::uint64_t leaves = 0;                                   // said goodbye
  std::uint64_t disconnects = 0;                              // were lost, silent or sent away after having joined
  std::uint64_t refusals = 0;                                 // never joined: full, busy, wrong version, no hello
  std::array<std::uint64_t, kGoodbyeReasonCount> goodbyes{};  // said to clients, by wire::GoodbyeReason
  std::uint64_t stalls = 0;  // of bodies that clients had to show without news of them in time, as they tell
  std::size_t clientsPeak = 0;
  std::array<std::uint64_t, kDropReasonCount> dropped{};           // messages by DropReason
  std::array<std::uint64_t, protocol::kParseResultCount> parse{};  // of kParse, by ParseResult
};

struct ClientCounts {
  std::size_t joining = 0;   // connected, no hello yet
  std::size_t playing = 0;   // with a body
  std::size_t watching = 0;  // without
  std::size_t leaving = 0;   // said goodbye to, or gone
};

class Server {
 public:
  // config and scene are valid. `now`, here and below: seconds, never backwards; the first tick is due at once.
  // bases: of the scene's blueprints, in their order; without them shapes take three times the bits. clock: to measure
  // what ticks take; without it they take no time, and the server never finds that it has too much to do.
  Server(const Config& config, scenes::Scene scene, std::unique_ptr<transport::Transport> transport, double now,
         std::vector<Bases> bases = {}, server::Clock clock = {});

  // Takes in messages and every tick that is due; returns how many that were. None while the world waits for somebody
  // to connect (Config::pauseAfter): then it goes on in the same call.
  int Tick(double now);
  // When Tick is to be called again.
  [[nodiscard]] double NextCall() const;
  [[nodiscard]] bool IsPaused() const { return m_isPaused; }

  // Whether the game has been played for Config::rounds.
  [[nodiscard]] bool IsMatchOver() const;
  // Says goodbye to everybody, and why, if there is more to say than that the server closes. Keep calling Poll until
  // IsEmpty, or give up; the world stands still.
  void Close(const std::string& why, double now);
  void Poll(double now) { Receive(now); }
  [[nodiscard]] bool IsClosing() const { return m_closing; }
  [[nodiscard]] bool IsEmpty() const { return m_sessions.empty(); }

  [[nodiscard]] const physics::World& World() const { return m_world; }
  [[nodiscard]] const Counts& ReadCounts() const { return m_counts; }
  [[nodiscard]] const Encoder& ReadEncoder() const { return m_encoder; }
  [[nodiscard]] const SendCounts& ReadSendCounts() const { return m_sender.Counts(); }
  [[nodiscard]] transport::Statistics ReadTransport() const { return m_transport->ReadStatistics(); }
  [[nodiscard]] const TickClock& Clock() const { return m_clock; }
  [[nodiscard]] std::size_t CountPlaying() const;
  [[nodiscard]] ClientCounts CountClients() const;
  // Fills in who plays or watches, in no order.
  void ListPlaying(std::vector<ClientId>& clients) const;
  // Whether somebody who says hello now is let in.
  [[nodiscard]] bool AcceptsJoins() const;
  // What each tick of the last call of Tick took.
  [[nodiscard]] std::span<const PhaseTimes> LastTicks() const { return m_lastTicks; }
  [[nodiscard]] const server::Load& ReadLoad() const { return m_load; }
  [[nodiscard]] const physics::StepReport& ReadReport() const { return m_report; }  // of the last step
  [[nodiscard]] int SnapshotHz() const { return m_snapshotHz; }

 private:
  void Receive(double now);
  void PauseOrGoOn(double now);
  void ApplyInputs();
  void Step();
  void Capture();
  const EncodedBody& Encode(std::size_t index, std::size_t quality);
  void Send(Share share, double now);
  void FollowLoad(std::size_t due, double now);

  void TakeEvent(const transport::Event& event, double now);
  void Join(Session& session);
  void End(Session& session, protocol::wire::GoodbyeReason reason, const std::string& detail);
  void ForgetPlayer(Session& session, bool unasked);
  void DropTimedOut(double now);
  [[nodiscard]] bool IsBusy() const;  // too busy to let anybody in

  // What players do beyond moving about: server_play.cpp.
  void Obey(Session& session, const Command& command);
  void ActByHand();
  void PlayGame();
  void NoteFall(const Session& session);
  void TellStandings();
  void TellTuning();
  void SendForces();
  void Notify(const Session& session, const std::string& text);
  [[nodiscard]] ClientId FindHost() const;  // who has played longest; 0: nobody plays

  void RespawnFallen();
  void Respawn(physics::BodyId body, const physics::Vector3d& place);
  // Blueprints that the world has changed or added since the last call, to everybody who plays.
  void PublishBlueprints();
  [[nodiscard]] const Bases& FindBases(std::size_t slot) const;
  void SendWelcome(Session& session);
  void Broadcast(const protocol::Message& message);
  void SendTo(const Session& session, const protocol::Message& message);
  // Captures and encodes on all threads what is likely to be taken of this share; the rest when somebody takes it.
  void EncodeAhead(Share share);
  [[nodiscard]] std::optional<Share> FindShare() const;  // of the bodies to be sent after this tick; none: no snapshot

  Config m_config;
  scenes::Scene m_scene;
  std::unique_ptr<transport::Transport> m_transport;
  physics::World m_world;
  std::vector<scenes::PlacedBody> m_sceneBodies;
  std::vector<CapturedGround> m_grounds;
  std::vector<Bases> m_bases;                   // of the scene's blueprints
  std::vector<CapturedBlueprint> m_blueprints;  // by slot
  std::uint64_t m_publishedRevision = 0;
  std::map<transport::ConnectionId, Session> m_sessions;
  BodyCaptures m_captures;
  Encoder m_encoder;
  std::vector<FreshCapture> m_fresh;  // EncodeAhead's
  SnapshotSender m_sender;
  TickClock m_clock;
  PhaseWatch m_watch;
  std::vector<PhaseTimes> m_lastTicks;
  server::Load m_load;
  int m_snapshotHz;  // as often as there is time for
  physics::StepReport m_report;
  Hands m_hands;
  Tuning m_tuning;
  std::optional<Workshop> m_workshop;
  std::optional<Sumo> m_game;
  std::uint64_t m_toldGame = 0;  // its revision
  Counts m_counts;
  double m_lastCompany;  // when somebody was connected last, or the server started
  double m_lastCall;
  bool m_isPaused = false;
  ClientId m_nextClientId = 1;
  bool m_closing = false;
};

}  // namespace wobble::server
