// Players of the scene `pitch` who chase one another as the script of `wobble_lab capacity` does, without sockets: each
// decides several times a second to run where the nearest other will be, and sometimes jumps.
#include <random>
#include <span>
#include <vector>

#include "server/scenes/loader.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {

using namespace physics;

namespace {

constexpr double kSight = 12;    // of a player, m
constexpr double kLeap = 2.5;    // jumps from this distance, m
constexpr double kLead = 0.2;    // aims so far ahead of who runs, s
constexpr double kTurnBack = 8;  // runs to the middle from here, m
constexpr double kJumps = 0.3;   // share of the decisions near another
constexpr int kLeastWait = 6;    // between decisions, ticks
constexpr int kMostWait = 12;

struct Player {
  BodyId body = 0;
  int wait = 0;  // until the next decision, ticks
  Control control;
};

// From 0 up to 1. tests/bench/random.h has a parameter that a header of Bullet, in this room too, has as a variable.
double Draw(std::mt19937_64& random) { return static_cast<double>(random() >> 11) / 9007199254740992.0; }

Vector3d FindVelocity(const Body& body) {
  Vector3d sum = Vector3d::Zero();
  const std::vector<Vector3d> velocities = ReadVelocities(body);
  for (const Vector3d& velocity : velocities) sum += velocity;
  return sum / static_cast<double>(velocities.size());
}

Control Decide(const World& world, std::span<const Player> players, const Player& player, std::mt19937_64& random) {
  const Vector3d own = world.FindCentre(world.ReadBody(player.body));
  double least = kSight;
  Vector3d way = Vector3d::Zero();
  for (const Player& other : players) {
    const Body& body = world.ReadBody(other.body);
    const double distance = (world.FindCentre(body) - own).norm();
    if (other.body == player.body || distance >= least) continue;
    least = distance;
    way = world.FindCentre(body) + kLead * FindVelocity(body) - own;
  }
  Control control;
  if (own.head<2>().norm() > kTurnBack) {
    way = -own;
  } else {
    control.jump = least < kLeap && Draw(random) < kJumps;
  }
  const double length = way.head<2>().norm();
  if (length > 0) control.moveX = way.x() / length;
  if (length > 0) control.moveY = way.y() / length;
  return control;
}

}  // namespace

std::unique_ptr<World> MakePlayersChasing(std::size_t count, const WorldSettings& settings, int ticks) {
  const scenes::Scene scene = scenes::LoadScene("pitch", scenes::FindShippedScenes()).scene;
  auto world = std::make_unique<World>(settings);
  (void)scenes::FillWorld(scene, 1, *world);
  std::mt19937_64 random(1);
  std::vector<Player> players(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vector3d place = scenes::FindFreeSpawn(scene.player, i, *world);
    players[i].body = world->AddBody(static_cast<std::uint8_t>(scene.player.blueprint), place);
    players[i].wait = static_cast<int>(i) % kLeastWait;
  }
  for (int tick = 0; tick < ticks; ++tick) {
    for (Player& player : players) {
      player.control.jump = false;
      if (--player.wait <= 0) {
        player.control = Decide(*world, players, player, random);
        player.wait = kLeastWait + static_cast<int>(Draw(random) * (kMostWait - kLeastWait + 1));
      }
      world->SetControl(player.body, player.control, scene.player.limits);
    }
    (void)world->Step();
  }
  return world;
}

}  // namespace wobble::bench
