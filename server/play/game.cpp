#include "server/play/game.h"

namespace wobble::server {
namespace {

using physics::Vector3d;

Game::Rules MakeLaws(scenes::GameRules::Kind kind) {
  using Kind = scenes::GameRules::Kind;
  if (kind == Kind::kGoals) return Goals{};
  if (kind == Kind::kCrown) return Crown{};
  return Sumo{};
}

// Visits the players who touch the body.
template <class Visit>
void VisitTouching(physics::BodyId body, const physics::World& world,
                   const std::map<physics::BodyId, ClientId>& players, Visit&& visit) {
  std::vector<physics::BodyId> touching;
  world.ListTouching(body, touching);
  for (const physics::BodyId other : touching) {
    const auto found = players.find(other);
    if (found != players.end()) visit(found->second);
  }
}

// From the centre of a body that is upright to one of its vertices, m.
Vector3d FindLift(const physics::Body& body, std::size_t vertex, const physics::World& world) {
  const std::vector<Vector3d>& rest = world.BlueprintOf(body).rest;
  return vertex < rest.size() ? rest[vertex] : Vector3d::Zero();
}

}  // namespace

Game::Game(const scenes::GameRules& rules, physics::BodyId object)
    : m_rules(rules), m_object(object), m_match(rules), m_laws(MakeLaws(rules.kind)) {}

bool Game::Write(const Memory& memory) {
  if (memory.rules.index() != m_laws.index()) return false;
  if (const Crown* crown = std::get_if<Crown>(&memory.rules); crown != nullptr && !crown->lift.allFinite())
    return false;
  if (!m_match.Write(memory.match)) return false;
  m_laws = memory.rules;
  return true;
}

ClientId Game::Bearer() const {
  const Crown* crown = std::get_if<Crown>(&m_laws);
  return crown != nullptr ? crown->bearer : 0;
}

void Game::Leave(ClientId client) {
  m_match.Leave(client);
  std::visit([&](auto& laws) { laws.Forget(client); }, m_laws);
}

void Game::BeginAnew() {
  m_laws = MakeLaws(m_rules.kind);
  m_match.Restart();
  static_cast<void>(m_match.TakePlacing());
}

physics::Control Game::FindControl(const physics::Control& control) const {
  return m_match.MayMove() ? control : physics::Control{};
}

physics::ControlLimits Game::FindLimits(ClientId client, const physics::ControlLimits& limits) const {
  physics::ControlLimits found = limits;
  if (client != Bearer()) return found;
  found.acceleration *= kBearersShare;
  found.speed *= kBearersShare;
  return found;
}

std::optional<HandCommand> Game::FindHand(const Actor& actor, const std::optional<HandCommand>& hand,
                                          const physics::World& world) const {
  if (actor.body == 0 || actor.client != Bearer()) return hand;
  const physics::Body& own = world.ReadBody(actor.body);
  const physics::Body& crown = world.ReadBody(m_object);
  return std::get<Crown>(m_laws).FindHand(m_object, world.FindCentre(own), world.BlueprintOf(own).reach,
                                          world.BlueprintOf(crown).reach);
}

scenes::PlayerRules Game::FindPlaces(ClientId client, const scenes::PlayerRules& player) const {
  scenes::PlayerRules places = player;
  const Match::Standing* standing = m_match.Find(client);
  if (standing != nullptr && standing->side != 0) {
    places.spawn.x() += standing->side == 1 ? -m_rules.kickOff : m_rules.kickOff;
  }
  return places;
}

ClientId Game::NoteFall(ClientId client) {
  if (Sumo* sumo = std::get_if<Sumo>(&m_laws)) return sumo->NoteFall(m_match, client);
  Crown* crown = std::get_if<Crown>(&m_laws);
  if (crown != nullptr && crown->bearer == client) crown->Drop();
  return 0;
}

bool Game::Follow(const physics::World& world, const Players& players, Hands& hands,
                  std::vector<Happening>& happenings) {
  if (Sumo* sumo = std::get_if<Sumo>(&m_laws)) FollowSumo(*sumo, world, players);
  if (Goals* goals = std::get_if<Goals>(&m_laws)) FollowGoals(*goals, world, players, hands, happenings);
  if (Crown* crown = std::get_if<Crown>(&m_laws)) FollowCrown(*crown, world, players, hands, happenings);
  m_match.Advance(world.Settings().tickDuration);
  if (!m_match.TakePlacing()) return false;
  m_laws = MakeLaws(m_rules.kind);
  if (m_object != 0) hands.LetGo(m_object);
  return true;
}

void Game::FollowSumo(Sumo& sumo, const physics::World& world, const Players& players) {
  for (const auto& [body, client] : players) {
    VisitTouching(body, world, players, [&, by = client](ClientId other) { sumo.NoteTouch(m_match, by, other); });
  }
}

void Game::FollowGoals(Goals& goals, const physics::World& world, const Players& players, const Hands& hands,
                       std::vector<Happening>& happenings) {
  VisitTouching(m_object, world, players, [&](ClientId client) { goals.NoteTouch(m_match, client); });
  for (const auto& [client, shove] : hands.Read().shoves) {
    if (shove.ticksLeft > 0 && shove.command.body == m_object) goals.NoteTouch(m_match, client);
  }
  ClientId scorer = 0;
  if (!goals.FollowBall(m_rules, world.FindCentre(world.ReadBody(m_object)), m_match, scorer)) return;
  happenings.push_back({.kind = Happening::Kind::kGoal, .body = m_object, .by = scorer});
}

void Game::FollowCrown(Crown& crown, const physics::World& world, const Players& players, Hands& hands,
                       std::vector<Happening>& happenings) {
  const physics::Body& body = world.ReadBody(m_object);
  Crown::Deeds deeds;
  for (const auto& [client, grip] : hands.Read().grips) {
    if (grip.vertices.empty() || grip.command.body != m_object) continue;
    deeds.grasps.push_back({client, grip.command, FindLift(body, grip.command.vertex, world)});
  }
  for (const auto& [client, shove] : hands.Read().shoves) {
    const auto pushed = players.find(shove.command.body);
    const bool isAtBearer = pushed != players.end() && pushed->second == crown.bearer && client != crown.bearer;
    deeds.isPushed = deeds.isPushed || (shove.ticksLeft > 0 && isAtBearer);
  }
  std::vector<ClientId> opened;
  const ClientId taker = crown.Follow(deeds, world.Settings().tickDuration, m_match, opened);
  for (const ClientId client : opened) hands.Open(client);
  if (taker == 0) return;
  hands.Right(taker, world);
  happenings.push_back({.kind = Happening::Kind::kCrown, .body = m_object, .by = taker});
}

}  // namespace wobble::server
