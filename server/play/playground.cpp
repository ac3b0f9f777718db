#include "server/play/playground.h"

#include <algorithm>
#include <cmath>

namespace wobble::server {

using physics::Vector3d;

namespace {

// More players than any server has: what a damaged recording could ask for.
constexpr std::size_t kMostPlayers = 4000;
constexpr double kFarthestMotion = 1e5;  // m, and m/s

template <class... Each>
struct Visitor : Each... {
  using Each::operator()...;
};

physics::WorldSettings MakeWorldSettings(const scenes::Scene& scene, const PlaygroundSettings& settings) {
  physics::WorldSettings world = scenes::MakeWorldSettings(scene, settings.tickDuration, settings.threads);
  world.widestPack = settings.widestPack;
  return world;
}

}  // namespace

Playground::Playground(scenes::Scene scene, const PlaygroundSettings& settings)
    : m_scene(std::move(scene)),
      m_seed(settings.seed),
      m_world(MakeWorldSettings(m_scene, settings)),
      m_sceneBodies(scenes::FillWorld(m_scene, settings.seed, m_world)),
      m_hands(m_scene.hands, settings.tickDuration),
      m_tuning(m_scene.tuning, m_scene.gravity) {
  OpenWorkshop();
  OpenGame();
}

void Playground::OpenWorkshop() {
  if (!m_scene.workshop.isOpen) return;
  const auto isWorkshop = [&](const physics::Body& body) { return body.blueprint == m_scene.workshop.blueprint; };
  m_workshop.emplace(m_scene.workshop, std::ranges::find_if(m_world.Bodies(), isWorkshop)->id, m_world);
}

void Playground::OpenGame() {
  if (m_scene.game.kind == scenes::GameRules::Kind::kNone) return;
  const auto isObject = [&](const physics::Body& body) { return body.blueprint == m_scene.game.object; };
  const bool hasObject = m_scene.game.HasObject();
  m_game.emplace(m_scene.game, hasObject ? std::ranges::find_if(m_world.Bodies(), isObject)->id : 0);
}

const Playground::Player* Playground::FindPlayer(ClientId client) const {
  const auto found = m_players.find(client);
  return found == m_players.end() ? nullptr : &found->second;
}

bool Playground::IsInForce(const MoveEntry& move) const {
  const Player* player = FindPlayer(move.client);
  return player != nullptr && player->control == move.control && player->hand == move.hand;
}

std::string Playground::Take(const Entry& entry) {
  if (m_listener) m_listener(entry);
  return std::visit([this](const auto& each) { return Do(each); }, entry);
}

std::string Playground::Do(const JoinEntry& join) {
  if (const auto found = m_players.find(join.client); found != m_players.end()) {
    found->second.name = join.name;
    return "";
  }
  if (join.client == 0 || m_players.size() >= kMostPlayers) return "";
  Player& player = m_players[join.client];
  player.name = join.name;
  if (join.isSpectator) return "";
  if (m_game) m_game->Enter(join.client, join.isBot);
  player.body = m_world.AddBody(static_cast<std::uint8_t>(m_scene.player.blueprint), FindStart(join.client));
  return "";
}

std::string Playground::Do(const LeaveEntry& leave) {
  const auto found = m_players.find(leave.client);
  if (found == m_players.end()) return "";
  if (found->second.body != 0) m_world.RemoveBody(found->second.body);
  m_players.erase(found);
  m_hands.Forget(leave.client);
  if (m_game) m_game->Leave(leave.client);
  if (m_players.empty()) m_tuning.Reset(m_world);
  return "";
}

std::string Playground::Do(const MoveEntry& move) {
  const auto found = m_players.find(move.client);
  if (found == m_players.end() || !IsPossible(move)) return "";
  found->second.control = move.control;
  found->second.hand = move.hand;
  return "";
}

std::string Playground::Do(const ActEntry& act) {
  const Player* player = FindPlayer(act.client);
  if (player == nullptr) return "";
  const physics::BodyId body = player->body;
  const Actor actor{act.client, body};
  const Workshop::Builder builder{act.client, act.mayChangeAll};
  return std::visit(
      Visitor{
          [&](const ShoveCommand& shove) {
            return shove.direction.allFinite() ? m_hands.StartShove(actor, shove, m_world) : std::string();
          },
          [&](const CutCommand& cut) { return Cut(act, body, cut); },
          [&](const TuneCommand& tune) {
            return body == 0 ? std::string(kSpectatorsCannotTune) : m_tuning.Tune(tune, act.isHost, m_world);
          },
          [&](const BuildCommand& build) {
            return !m_workshop || body == 0 ? std::string("only players in a scene with a workshop can build")
                                            : m_workshop->Build(builder, build, m_world);
          },
      },
      act.command);
}

std::string Playground::Cut(const ActEntry& act, physics::BodyId body, const CutCommand& cut) {
  std::string error;
  const auto blade = m_hands.FindBlade({act.client, body}, cut, m_world, error);
  if (!blade) return error;
  if (m_workshop && cut.body == m_workshop->Body()) {
    return m_workshop->Cut({act.client, act.mayChangeAll}, *blade, m_world);
  }
  m_world.CutSprings(cut.body, *blade);
  return error;
}

std::string Playground::Do(const ProtectEntry& protect) {
  if (m_workshop) m_workshop->SetProtected(protect.isProtected);
  return "";
}

std::string Playground::Do(const ResetEntry& /*reset*/) {
  m_tuning.Reset(m_world);
  for (const scenes::PlacedBody& placed : m_sceneBodies) {
    if (m_workshop && placed.body == m_workshop->Body()) {
      m_workshop->Reset(placed.home);
    } else {
      Respawn(placed.body, placed.home);
    }
  }
  return "";
}

std::string Playground::Do(const RestartEntry& /*restart*/) {
  m_tuning.Reset(m_world);
  m_hands = Hands(m_scene.hands, m_world.Settings().tickDuration);
  scenes::RefillWorld(m_scene, m_seed, m_sceneBodies, m_world);
  for (const scenes::PlacedBody& placed : m_sceneBodies) {
    m_happenings.push_back({.kind = Happening::Kind::kRespawn, .body = placed.body});
  }
  const bool isProtected = m_workshop && m_workshop->IsProtected();
  OpenWorkshop();
  if (m_workshop) m_workshop->SetProtected(isProtected);
  if (m_game) m_game->BeginAnew();
  for (const auto& [client, player] : m_players) {
    if (player.body == 0) continue;
    m_world.RenewBody(player.body, static_cast<std::uint8_t>(m_scene.player.blueprint), FindStart(client));
    m_happenings.push_back({.kind = Happening::Kind::kRespawn, .body = player.body});
  }
  return "";
}

std::string Playground::Do(const ReadyEntry& ready) {
  if (m_game) m_game->SetReady(ready.client, ready.isReady);
  return "";
}

std::string Playground::Do(const MatchEntry& match) {
  if (m_game && match.rounds >= 0) m_game->SetRounds(match.rounds);
  return "";
}

std::string Playground::Do(const MotionEntry& motion) {
  const physics::Body* body = m_world.FindBody(motion.body);
  if (body == nullptr) return "";
  const std::size_t count = m_world.BlueprintOf(*body).rest.size();
  const auto isPossible = [](const Vector3d& each) { return each.cwiseAbs().maxCoeff() <= kFarthestMotion; };
  const bool isGood = motion.positions.size() == count && motion.velocities.size() == count &&
                      std::ranges::all_of(motion.positions, isPossible) &&
                      std::ranges::all_of(motion.velocities, isPossible);
  if (isGood) m_world.SetMotion(motion.body, motion.positions, motion.velocities);
  return "";
}

physics::StepReport Playground::Step() {
  MovePlayers();
  m_hands.Act(m_world);
  if (m_workshop && m_workshop->Update(m_world)) m_hands.LetGo(m_workshop->Body());
  const physics::StepReport report = m_world.Step();
  RespawnFallen();
  if (m_game) PlayGame();
  return report;
}

void Playground::MovePlayers() {
  for (const auto& [client, player] : m_players) {
    const Actor actor{client, player.body};
    if (player.body != 0) {
      m_world.SetControl(player.body, m_game ? m_game->FindControl(player.control) : player.control,
                         m_game ? m_game->FindLimits(client, m_scene.player.limits) : m_scene.player.limits);
    }
    m_hands.Hold(actor, m_game ? m_game->FindHand(actor, player.hand, m_world) : player.hand, m_world);
  }
}

void Playground::RespawnFallen() {
  const auto hasFallen = [&](physics::BodyId body) {
    const Vector3d centre = m_world.FindCentre(m_world.ReadBody(body));
    return centre.z() < m_scene.killHeight || centre.cwiseAbs().maxCoeff() > kBorder;
  };
  // Both lists ascend by id. Only bodies that were stepped can have fallen.
  auto placed = m_sceneBodies.begin();
  for (const std::uint32_t place : m_world.Changes().stepped) {
    const physics::BodyId body = m_world.Bodies()[place].id;
    placed = std::lower_bound(placed, m_sceneBodies.end(), body,
                              [](const scenes::PlacedBody& each, physics::BodyId id) { return each.body < id; });
    if (placed == m_sceneBodies.end()) break;
    if (placed->body == body && hasFallen(body)) Respawn(body, placed->home);
  }
  for (const auto& [client, player] : m_players) {
    if (player.body == 0 || m_world.ReadBody(player.body).asleep || !hasFallen(player.body)) continue;
    if (m_game) {
      m_happenings.push_back({.kind = Happening::Kind::kFall, .body = player.body, .by = m_game->NoteFall(client)});
    }
    RespawnPlayer(client, player);
  }
}

void Playground::Respawn(physics::BodyId body, const Vector3d& place) {
  m_world.PlaceBody(body, place);
  m_happenings.push_back({.kind = Happening::Kind::kRespawn, .body = body});
}

Vector3d Playground::FindStart(ClientId client) const {
  return scenes::FindFreeSpawn(m_game ? m_game->FindPlaces(client, m_scene.player) : m_scene.player, client, m_world);
}

void Playground::RespawnPlayer(ClientId client, const Player& player) { Respawn(player.body, FindStart(client)); }

void Playground::PlayGame() {
  std::map<physics::BodyId, ClientId> players;
  for (const auto& [client, player] : m_players) {
    if (player.body != 0) players[player.body] = client;
  }
  if (m_game->Follow(m_world, players, m_hands, m_happenings)) PlaceAll();
}

// Players first leave the field, so that nobody's old place is in another one's way.
void Playground::PlaceAll() {
  constexpr double kAside = 100, kApart = 10;  // m
  Vector3d aside = m_scene.player.spawn + Vector3d(0, 0, kAside);
  for (const auto& [client, player] : m_players) {
    if (player.body != 0) m_world.PlaceBody(player.body, aside += Vector3d(0, 0, kApart));
  }
  for (const scenes::PlacedBody& placed : m_sceneBodies) {
    if (placed.body == m_game->Object()) Respawn(placed.body, placed.home);
  }
  for (const auto& [client, player] : m_players) {
    if (player.body != 0) RespawnPlayer(client, player);
  }
}

}  // namespace wobble::server
