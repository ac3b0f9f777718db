// A world with its players and the rules of play: all that decides the next tick, and nothing else. A playground knows
// no packet, session, wall clock or log. Whatever changes it comes in by Take, so that the same entries at the same
// ticks give the same bits: a server plays it for its clients, and a recording plays it again (server/recording).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/physics/world.h"
#include "server/play/entry.h"
#include "server/play/game.h"
#include "server/play/hands.h"
#include "server/play/tuning.h"
#include "server/play/workshop.h"
#include "server/scenes/scene.h"

namespace wobble::server {

// A body farther than this from the origin along an axis, m, respawns like one that fell: a tenth farther it could not
// be shown on the wire.
inline constexpr double kBorder = 7372;

struct PlaygroundState;

struct PlaygroundSettings {
  double tickDuration = 1.0 / 60;  // s
  std::uint64_t seed = 1;          // of the scene's random placement
  // The bits do not depend on what follows.
  int threads = 1;
  int widestPack = physics::WorldSettings{}.widestPack;
};

class Playground {
 public:
  // scene: valid.
  Playground(scenes::Scene scene, const PlaygroundSettings& settings);

  struct Player {
    physics::BodyId body = 0;  // 0: a spectator
    std::string name;
    physics::Control control;
    std::optional<HandCommand> hand;
  };

  // Everything that changes the playground, beside time. Acts at once. Any entry is safe: what cannot be, such as one
  // of a client that is not in, does nothing. Returns the reason of a refusal, to be shown to the player; empty: none,
  // or nothing to say.
  std::string Take(const Entry& entry);
  // Called with every entry before it acts.
  void SetListener(std::function<void(const Entry&)> listener) { m_listener = std::move(listener); }

  // Plays a tick: hands, the workshop, the world, respawns, the game.
  physics::StepReport Step();

  // All that the next ticks depend on, beside the scene, the tick duration and the seed.
  [[nodiscard]] PlaygroundState Capture() const;
  // Goes on from a state of a playground of the same scene, tick duration and seed, to the bit. Any state is safe.
  // Returns an empty text, or what is wrong with the state: the playground is then of no use.
  [[nodiscard]] std::string Restore(const PlaygroundState& state);

  // What has happened since the last call, in its order.
  [[nodiscard]] std::vector<Happening> TakeHappenings() { return std::exchange(m_happenings, {}); }

  [[nodiscard]] const scenes::Scene& Scene() const { return m_scene; }
  [[nodiscard]] const physics::World& World() const { return m_world; }
  [[nodiscard]] const std::map<ClientId, Player>& Players() const { return m_players; }
  [[nodiscard]] const Player* FindPlayer(ClientId client) const;
  // Whether Take would change nothing.
  [[nodiscard]] bool IsInForce(const MoveEntry& move) const;
  [[nodiscard]] const Tuning& ReadTuning() const { return m_tuning; }
  // Null: the scene has none.
  [[nodiscard]] const Workshop* ReadWorkshop() const { return m_workshop ? &*m_workshop : nullptr; }
  [[nodiscard]] const Game* ReadGame() const { return m_game ? &*m_game : nullptr; }

 private:
  std::string Do(const JoinEntry& join);
  std::string Do(const LeaveEntry& leave);
  std::string Do(const MoveEntry& move);
  std::string Do(const ActEntry& act);
  std::string Do(const ProtectEntry& protect);
  std::string Do(const ResetEntry& reset);
  std::string Do(const RestartEntry& restart);
  std::string Do(const ReadyEntry& ready);
  std::string Do(const MatchEntry& match);
  std::string Do(const MotionEntry& motion);
  std::string Cut(const ActEntry& act, physics::BodyId body, const CutCommand& cut);

  void OpenWorkshop();
  void OpenGame();
  void MovePlayers();
  void RespawnFallen();
  void Respawn(physics::BodyId body, const physics::Vector3d& place);
  void RespawnPlayer(ClientId client, const Player& player);
  // Where a player starts, m.
  [[nodiscard]] physics::Vector3d FindStart(ClientId client) const;
  void PlayGame();
  void PlaceAll();

  scenes::Scene m_scene;
  std::uint64_t m_seed;
  physics::World m_world;
  std::vector<scenes::PlacedBody> m_sceneBodies;  // by ascending id
  std::map<ClientId, Player> m_players;
  Hands m_hands;
  Tuning m_tuning;
  std::optional<Workshop> m_workshop;
  std::optional<Game> m_game;
  std::vector<Happening> m_happenings;
  std::function<void(const Entry&)> m_listener;
};

}  // namespace wobble::server
