// The room server/ hosts: a world, its clients, and the tick that joins them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/transport/transport.h"
#include "server/config.h"
#include "server/recording/checkpoints.h"
#include "server/recording/film.h"
#include "server/recording/recorder.h"
#include "server/session.h"
#include "server/snapshots/snapshot_budget.h"
#include "server/stage.h"
#include "server/timing/load_level.h"
#include "server/timing/phases.h"
#include "server/timing/tick_clock.h"
#include "server/vote.h"

namespace wobble::server {

inline constexpr std::size_t kGoodbyeReasonCount = static_cast<std::size_t>(protocol::wire::GoodbyeReason::MAX) + 1;

// Totals since the start, for the summary (summary.h) and the metrics (ops/metrics.h).
struct Counts {
  std::uint64_t substeps = 0;  // over bodies and ticks
  std::uint64_t awakeSum = 0;  // awake bodies, summed over ticks
  std::uint64_t nonFinite = 0;
  std::uint64_t inverted = 0;
  std::uint64_t quarantined = 0;
  std::uint64_t reset = 0;
  std::uint64_t torn = 0;  // springs
  std::uint64_t respawns = 0;
  double pausedTime = 0;              // s
  std::uint64_t coarsenedBefore = 0;  // records, of the scenes before (Server::CoarsenedRecords)
  std::uint64_t joins = 0;
  std::uint64_t leaves = 0;                                   // clients that said goodbye
  std::uint64_t disconnects = 0;                              // clients lost, silent or sent away after they had joined
  std::uint64_t refusals = 0;                                 // connections ended before they had joined; see
                                                              // also transport::Statistics::turnaways
  std::array<std::uint64_t, kGoodbyeReasonCount> goodbyes{};  // said to clients, by wire::GoodbyeReason
  std::uint64_t inputsDue = 0;                                // ticks, summed over players
  std::uint64_t inputsStarved = 0;  // ticks on which a player stood still because no input had come in time
  std::uint64_t stalls = 0;         // bodies that a client had to show without news in time, as clients report
  std::uint64_t said = 0;           // lines of players that went to everybody
  std::uint64_t emotes = 0;
  std::uint64_t renames = 0;
  std::uint64_t talkRefused = 0;  // lines, emotes and renames that did not go through, by any reason
  std::size_t clientsPeak = 0;
  std::array<std::uint64_t, kDropReasonCount> dropped{};           // messages, by DropReason
  std::array<std::uint64_t, protocol::kParseResultCount> parse{};  // messages of kParse, by ParseResult
};

// How long a player of a server that was killed may take to come back to their body, s: as long as clients try.
inline constexpr double kSeatPatience = 60;

// Why a muted player's command is not obeyed.
inline constexpr const char* kMuted = "you may only move: a moderator has muted you";

// The game of a Welcome to a recording.
inline constexpr const char* kFilm = "film";

// Connections, by state.
struct ClientCounts {
  std::size_t joining = 0;   // connected, no hello yet
  std::size_t playing = 0;   // joined, with a body
  std::size_t watching = 0;  // joined as a spectator
  std::size_t leaving = 0;   // goodbye said, connection not yet closed
};

// Single-threaded: all calls come from one thread.
class Server {
 public:
  // config and scene are valid (Validate). now, here and below: s, never backwards; the first tick is due at once.
  // bases: of the scene's blueprints, in their order; without them shapes take three times the bits. clock: measures
  // how long ticks take; without it they take no time, and the load level never rises.
  Server(const Config& config, scenes::Scene scene, std::unique_ptr<transport::Transport> transport, double now,
         std::vector<Bases> bases = {}, TimeSource clock = {});
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Takes in messages and plays every tick that is due; returns how many. Returns 0 while the world is paused because
  // nobody is connected (Config::pauseAfter); the call that receives the first connection resumes it.
  int Tick(double now);
  // When to call Tick again, s.
  [[nodiscard]] double NextCall() const;
  [[nodiscard]] bool IsPaused() const { return m_isPaused; }

  // Whether Config::rounds rounds of the game have been played and the server is to end. Only with AfterMatch::kEnd.
  [[nodiscard]] bool IsMatchOver() const;
  // Says goodbye to all clients. why: added to the reason that the server closes; may be empty. The world stops; call
  // Poll until IsEmpty or until a deadline.
  void Close(const std::string& why, double now);
  void Poll(double now) { Receive(now); }
  [[nodiscard]] bool IsClosing() const { return m_isClosing; }
  // Whether no connection is left.
  [[nodiscard]] bool IsEmpty() const { return m_sessions.empty(); }

  // Records all that is played from here on. Call it before the first Tick, after Resume.
  void Record(recording::RecorderSettings settings, recording::Head head);
  // Ends the recording, with all that was played.
  void EndRecording();
  // Null: nothing is recorded.
  [[nodiscard]] const recording::Recorder* ReadRecorder() const { return m_recorder.get(); }

  // server_film.cpp: shows a recording instead of playing: whoever comes in watches. Call it before the first Tick; the
  // server's scene, tick rate and seed are the recording's. Returns what is wrong with the file; empty: nothing.
  [[nodiscard]] std::string Show(std::unique_ptr<recording::Film> film);
  // Null: nothing is shown.
  [[nodiscard]] recording::Film* ReadFilm() { return m_film.get(); }

  // server_resume.cpp: the state that outlives the process. Saves it once a second from here on, and as the world
  // pauses or the server closes.
  void KeepState(std::unique_ptr<recording::Checkpoints> checkpoints);
  // Goes on from there, before the first Tick. Players who were in have kSeatPatience to come back to their bodies with
  // the tickets that they were given. Returns what is wrong; empty: nothing.
  [[nodiscard]] std::string Resume(const recording::Checkpoint& checkpoint, double now);
  // Null: it is not kept.
  [[nodiscard]] const recording::Checkpoints* ReadCheckpoints() const { return m_checkpoints.get(); }
  // Players who have not come back yet.
  [[nodiscard]] std::size_t CountEmptySeats() const { return m_emptySeats.size(); }

  // server_rotation.cpp: the scenes that follow one another, with all clients taken along; the first is that of the
  // constructor. Two or more, of different names, each valid with the config. Call it before the first Tick, and before
  // KeepState and Record.
  void Rotate(std::vector<RotationScene> scenes);
  // Goes to a scene of the rotation before the first Tick.
  void BeginWith(std::size_t scene);
  // Their names; empty: the server stays in its scene.
  [[nodiscard]] std::vector<std::string> ListRotation() const;
  // The present one's number in it; 0 without a rotation.
  [[nodiscard]] std::size_t SceneNumber() const { return m_scene; }
  [[nodiscard]] const std::string& SceneName() const { return m_stage->playground.Scene().name; }
  // Goes to that scene of the rotation, or to the one behind the present one, within moments: it is made on another
  // thread, while the present one is played on. Returns the reason of a refusal; empty: none.
  std::string GoToScene(const std::string& name);
  std::string GoToNextScene();

  // server_admin.cpp: what the administration asks for (server/admin). False, where it is returned: no such client is
  // in.
  struct Player {
    ClientId client = 0;
    std::string name;
    transport::Admission admission;
    bool isSpectator = false;
    bool isMuted = false;
    double mutedFor = 0;   // s from now on; infinite: for good
    int points = 0;        // of this round, where a game is played
    double seconds = 0;    // since it connected
    double roundTrip = 0;  // newest measured, s
    double rate = 0;       // that its snapshots may take, bit/s
  };
  [[nodiscard]] std::vector<Player> ListPlayers(double now) const;
  // Sends a client away. why: a line for it, may be empty.
  bool Dismiss(ClientId client, protocol::wire::GoodbyeReason reason, const std::string& why);
  // A muted player moves, and does nothing else; both changes are told to it. until: s. It stays muted when it comes
  // back with its ticket or account.
  bool Mute(ClientId client, double until = std::numeric_limits<double>::infinity());
  bool Unmute(ClientId client);
  bool SetRank(ClientId client, transport::Rank rank);
  // While it is locked nobody but moderators and owners comes in.
  void SetLocked(bool isLocked) { m_isLocked = isLocked; }
  [[nodiscard]] bool IsLocked() const { return m_isLocked; }
  // Whether players may change what others built. False: the scene has no workshop.
  bool SetProtected(bool isProtected);
  [[nodiscard]] bool IsProtected() const;
  // ResetEntry (play/entry.h), and the usual pace of time.
  void ResetWorld();
  // RestartEntry, and the usual pace of time. Acts at once, on a paused world as well.
  void RestartWorld();
  // What players vote on.
  enum class Question : std::uint8_t { kRestart, kNextScene };
  // Takes a player's voice and tells everybody the count. More than half of the players, without spectators and muted
  // ones, decide (vote.h), unless the world is protected. One question at a time. Returns the reason of a refusal, for
  // the player; empty: the voice counts.
  std::string VoteFor(Question question, ClientId client, double now);
  // Whether a player waits for the match to begin. Returns the reason of a refusal, for the player; empty: none.
  std::string SetReady(ClientId client, bool isReady);
  // The game that is played; null: none.
  [[nodiscard]] const Game* ReadGame() const { return m_stage->playground.ReadGame(); }
  // A line for everybody, and for one client.
  void Say(const std::string& text);
  bool Tell(ClientId client, const std::string& text);
  // Carries out the orders that clients send: takes the client, its rank and the line, and returns lines of answer.
  // Without it orders are refused.
  using OrderTaker = std::function<std::vector<std::string>(ClientId, transport::Rank, const std::string& line)>;
  void SetOrderTaker(OrderTaker taker) { m_orderTaker = std::move(taker); }

  // The tick that clients are told: one more with each step. It is the world's, unless a recording is shown.
  [[nodiscard]] std::uint32_t ShownTick() const { return m_shownTick; }
  [[nodiscard]] const physics::World& World() const { return m_stage->playground.World(); }
  [[nodiscard]] const Counts& ReadCounts() const { return m_counts; }
  // Records so far that missed their error target to fit into a packet, or did not fit at all.
  [[nodiscard]] std::uint64_t CoarsenedRecords() const {
    return m_counts.coarsenedBefore + m_stage->store.ReadEncoder().CoarsenedRecords();
  }
  [[nodiscard]] const SendCounts& ReadSendCounts() const { return m_budget.Counts(); }
  [[nodiscard]] transport::Statistics ReadTransport() const { return m_transport->ReadStatistics(); }
  [[nodiscard]] const TickClock& Clock() const { return m_clock; }
  // Clients that have joined, players and spectators.
  [[nodiscard]] std::size_t CountPlaying() const;
  [[nodiscard]] ClientCounts CountClients() const;
  // Replaces `clients` by the numbers of the clients that have joined, in no particular order.
  void ListPlaying(std::vector<ClientId>& clients) const;
  // Whether a client that says hello now would be let in.
  [[nodiscard]] bool AcceptsJoins() const;
  // The phases of each tick that the last call of Tick played.
  [[nodiscard]] std::span<const PhaseTimes> LastTicks() const { return m_lastTicks; }
  [[nodiscard]] const LoadController& ReadLoad() const { return m_load; }
  [[nodiscard]] const physics::StepReport& ReadReport() const { return m_report; }  // of the last step
  // The snapshot rate in force: Config::snapshotHz, or less under load.
  [[nodiscard]] int SnapshotHz() const { return m_snapshotHz; }

 private:
  // The five stages of a tick, in their order.
  void Receive(double now);
  void Step();
  void Capture();
  void Encode(BodySubset due);
  void Send(BodySubset due, double now);

  void ShowFilm();
  void TellFilmPlayers();
  void SaveState();
  // The player who has come back takes their body again. False: there is no seat for them.
  bool TakeSeat(Session& session);
  void ClearSeats(double now);

  void PauseOrResume(double now);
  // Begins the next match in the same process, if Config::afterMatch says so and the last one is over.
  void FollowMatch();
  void MakeNextStage(std::size_t scene);
  // Goes to the next scene once it is made.
  void FollowRotation(double now);
  // Begins with the stage, in place of the present one; nobody is in it.
  void TakeStage(std::unique_ptr<Stage> stage, std::size_t scene);
  void RecordStage();
  // The client says hello again, for the scene that has just begun.
  void TakeAlong(Session& session, double now);
  // When the last client has left, if Config::resetsWhenEmpty says so.
  void BeginAnew();
  // The bodies of the snapshot that is due after this tick; nullopt: none is due.
  [[nodiscard]] std::optional<BodySubset> FindDueBodies() const;
  // Adapts snapshots and world time to the load; ticks: how many the last call played because they were due.
  void FollowLoad(std::size_t ticks, double now);
  void ApplyInputs();
  // Lets all who have joined download blueprints that are new or have changed.
  void PublishBlueprints();

  // server_joins.cpp: connections, from their first byte to their goodbye.
  void TakeEvent(const transport::Event& event, double now);
  void Join(Session& session);
  // False, and it is refused: there is no room.
  bool LetIn(Session& session);
  void SendWelcome(Session& session);
  // Sends heights and blueprints that are due to all who have joined.
  void SendDownloads();
  // Refuses or removes a client: says goodbye with a reason and closes the connection.
  void End(Session& session, protocol::wire::GoodbyeReason reason, const std::string& detail);
  // Takes a client that had joined out of the world and the game; does nothing for other sessions. isLost: it did not
  // leave by itself.
  void ForgetPlayer(Session& session, bool isLost);
  void EndTimedOut(double now);
  [[nodiscard]] bool IsBusy() const;
  void Broadcast(const protocol::Message& message);
  void SendTo(const Session& session, const protocol::Message& message);

  // server_play.cpp: what players do beyond moving.
  void Obey(Session& session, const Command& command, double now);
  // Returns the reason of a refusal, for the player.
  std::string Tune(const Session& session, const TuneCommand& command, double now);
  std::string Act(const Session& session, const ActEntry& act);
  void TakeOrder(Session& session, const std::string& line);
  // Tells clients what has happened in the playground since the last call.
  void TellHappenings();
  // Config::rounds instead of what the scene says.
  void SetRounds();
  void TellStandings();
  void SendStandings();
  void SendTuning();
  void SendForces();
  void Notify(const Session& session, const std::string& text);
  [[nodiscard]] bool HasPlayedAllRounds() const;

  // server_talk.cpp: what players tell one another.
  void TakeTalk(Session& session, const TalkCommand& talk, double now);
  // They return the reason of a refusal, for the player.
  std::string Do(Session& session, const SayCommand& say, double now);
  std::string Do(Session& session, const EmoteCommand& emote, double now);
  std::string Do(Session& session, const RenameCommand& rename, double now);
  // Bits kMaySay and kMayEmote.
  [[nodiscard]] std::uint8_t FindTalk(const Session& session) const;
  // The session's name, changed so that it looks like nobody else's who is in.
  [[nodiscard]] std::string FindFreeName(const Session& session, const std::string& name) const;

  // server_admin.cpp
  // A newcomer who was muted before is muted again.
  void RecallMute(Session& session, double now);
  // Takes mutes back whose time is over.
  void LiftMutes(double now);
  // Takes an entry that puts the world back to what the scene has, and restores the pace of time.
  void PutBack(const Entry& entry);
  // Those who may vote: players who are in and not muted.
  [[nodiscard]] std::vector<ClientId> ListVoters() const;
  // Restarts the world if the open vote has passed; tells everybody how it ended.
  void FollowVote(double now);
  [[nodiscard]] Session* FindSession(ClientId client);

  Config m_config;
  std::unique_ptr<transport::Transport> m_transport;
  std::uint32_t m_shownTick = 0;
  std::unique_ptr<recording::Film> m_film;
  std::map<ClientId, std::pair<physics::BodyId, std::string>> m_filmPlayers;  // as clients were told
  std::unique_ptr<recording::Recorder> m_recorder;
  std::unique_ptr<recording::Checkpoints> m_checkpoints;
  std::map<ClientId, recording::Identity> m_emptySeats;  // of players who have not come back after Resume
  double m_seatsUntil = 0;                               // s
  std::map<transport::ConnectionId, Session> m_sessions;
  TickClock m_clock;
  PhaseWatch m_watch;
  std::vector<PhaseTimes> m_lastTicks;
  std::unique_ptr<Stage> m_stage;
  std::vector<RotationScene> m_rotation;  // empty: none
  std::size_t m_scene = 0;                // of m_rotation, the present one
  std::size_t m_nextScene = 0;            // likewise, of m_nextStage
  std::future<std::unique_ptr<Stage>> m_nextStage;
  SnapshotBudget m_budget;
  LoadController m_load;
  int m_snapshotHz;
  physics::StepReport m_report;
  Pace m_pace;
  std::optional<std::uint64_t> m_sentStandings;  // Match::Revision of the standings sent last; nullopt: none
  Counts m_counts;
  double m_lastCompany;  // when a connection was there last, or the server started, s
  double m_lastCall;     // s
  bool m_isPaused = false;
  ClientId m_nextClientId = 1;
  bool m_isClosing = false;
  bool m_isLocked = false;
  OrderTaker m_orderTaker;
  Allowance m_talk;     // lines and emotes of all clients together
  Allowance m_renames;  // likewise
  // Who was muted, by what they are known by when they come back; the newest last.
  struct MutedOne {
    std::uint64_t account = 0;
    std::array<std::uint8_t, 16> identity{};
    double until = 0;  // s
  };
  std::vector<MutedOne> m_mutedOnes;
  Vote m_vote;
  Question m_question = Question::kRestart;  // of m_vote
};

}  // namespace wobble::server
