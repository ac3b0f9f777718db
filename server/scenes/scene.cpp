#include "server/scenes/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/shapes/finish_blueprint.h"

namespace wobble::scenes {
namespace {

using physics::Vector3d;

// SplitMix64 (Steele, Lea & Flood 2014). Its whole state is a counter, and unlike the distributions of <random> it
// gives the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : m_state(seed) {}
  // Uniform in [-1, 1).
  double NextSigned() {
    std::uint64_t z = (m_state += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    z ^= z >> 31;
    return static_cast<double>(z >> 11) * 0x1.0p-52 - 1.0;
  }

 private:
  std::uint64_t m_state;
};

void Stretch(const BodyGroup& group, physics::BodyId body, const Vector3d& home, physics::World& world) {
  std::vector<Vector3d> places;
  physics::VisitVertices(world.ReadBody(body), [&](std::size_t /*index*/, const Vector3d& place) {
    places.emplace_back(home + (place - home).cwiseProduct(group.stretch));
  });
  world.SetMotion(body, places, std::vector<Vector3d>(places.size(), group.velocity));
}

// place(group, home): adds the body, or makes it new, and returns its number.
template <class Place>
void PlaceGroup(const BodyGroup& group, Random& random, physics::World& world, const Place& place) {
  for (int iz = 0; iz < group.count[2]; ++iz) {
    for (int iy = 0; iy < group.count[1]; ++iy) {
      for (int ix = 0; ix < group.count[0]; ++ix) {
        Vector3d home = group.position + Vector3d(ix, iy, iz).cwiseProduct(group.spacing);
        for (int axis = 0; axis < 3; ++axis) home[axis] += group.jitter * random.NextSigned();
        const physics::BodyId body = place(group, home);
        if (group.stretch != Vector3d::Ones()) Stretch(group, body, home, world);
      }
    }
  }
}

void AddDrives(const DriveRule& rule, const Scene& scene, std::span<const PlacedBody> placed, physics::World& world) {
  physics::Drive drive = rule.drive;
  if (!rule.blueprint) return world.AddDrive(drive);
  if (drive.force != Vector3d::Zero()) {
    drive.vertices = FindSide(scene.blueprints[*rule.blueprint], world.Blueprints()[*rule.blueprint].rest, rule.side);
  }
  for (const PlacedBody& each : placed) {
    if (world.ReadBody(each.body).blueprint != *rule.blueprint) continue;
    drive.body = each.body;
    world.AddDrive(drive);
  }
}

}  // namespace

physics::WorldSettings MakeWorldSettings(const Scene& scene, double tickDuration, int threads) {
  physics::WorldSettings settings;
  settings.gravity = scene.gravity;
  settings.wind = scene.wind;
  settings.tickDuration = tickDuration;
  settings.precision = scene.precision;
  settings.threads = threads;
  settings.errorTarget = scene.errorTarget;
  settings.maxSubsteps = scene.maxSubsteps;
  return settings;
}

std::vector<PlacedBody> FillWorld(const Scene& scene, std::uint64_t seed, physics::World& world) {
  for (const physics::Obstacle& obstacle : scene.obstacles) world.AddObstacle(obstacle);
  for (std::size_t i = 0; i < scene.blueprints.size(); ++i) {
    physics::Blueprint blueprint = MakeBlueprint(scene.blueprints[i]);
    const Methods methods = i < scene.methods.size() ? scene.methods[i] : Methods{};
    SetIntegrator(blueprint, methods.integrator);
    SetContactLaw(blueprint, methods.contactLaw, methods.magneticStrength);
    world.AddBlueprint(std::move(blueprint));
  }
  Random random(seed);
  std::vector<PlacedBody> placed;
  const auto add = [&](const BodyGroup& group, const Vector3d& home) {
    placed.push_back({world.AddBody(static_cast<std::uint8_t>(group.blueprint), home, group.velocity), home});
    return placed.back().body;
  };
  for (const BodyGroup& group : scene.groups) PlaceGroup(group, random, world, add);
  for (const DriveRule& rule : scene.drives) AddDrives(rule, scene, placed, world);
  return placed;
}

void RefillWorld(const Scene& scene, std::uint64_t seed, std::span<const PlacedBody> placed, physics::World& world) {
  Random random(seed);
  auto next = placed.begin();
  const auto renew = [&](const BodyGroup& group, const Vector3d& home) {
    world.RenewBody(next->body, static_cast<std::uint8_t>(group.blueprint), home, group.velocity);
    return next++->body;
  };
  for (const BodyGroup& group : scene.groups) PlaceGroup(group, random, world, renew);
  // A drive of all bodies is still there.
  for (const DriveRule& rule : scene.drives) {
    if (rule.blueprint) AddDrives(rule, scene, placed, world);
  }
}

Vector3d FindSpawn(const PlayerRules& player, std::uint32_t index) {
  constexpr double kGoldenAngle = 2.39996322972865332;
  const double angle = kGoldenAngle * index;
  return player.spawn + player.spawnRadius * Vector3d(std::cos(angle), std::sin(angle), 0);
}

Vector3d FindFreeSpawn(const PlayerRules& player, std::uint32_t index, const physics::World& world) {
  constexpr std::uint32_t kPlacesALayer = 16;
  constexpr int kLayers = 16;
  const double reach = world.Blueprints()[player.blueprint].reach;
  std::vector<Vector3d> centres;
  std::vector<double> reaches;
  for (const physics::Body& body : world.Bodies()) {
    centres.push_back(world.FindCentre(body));
    reaches.push_back(world.BlueprintOf(body).reach);
  }
  const auto isFree = [&](const Vector3d& place) {
    for (std::size_t i = 0; i < centres.size(); ++i) {
      if ((centres[i] - place).norm() < reach + reaches[i]) return false;
    }
    return true;
  };
  for (int layer = 0; layer < kLayers; ++layer) {
    for (std::uint32_t next = 0; next < kPlacesALayer; ++next) {
      const Vector3d place = FindSpawn(player, index + next) + Vector3d(0, 0, 2.1 * reach * layer);
      if (isFree(place)) return place;
    }
  }
  return FindSpawn(player, index);
}

std::vector<std::uint16_t> FindSide(const BlueprintDefinition& definition, const std::vector<Vector3d>& rest,
                                    physics::Side side) {
  using physics::Side;
  constexpr double kShareOfFlat = 0.02;
  constexpr double kShareOfRound = 0.1;
  const auto* solid = std::get_if<physics::SolidDefinition>(&definition);
  const bool isRound = (solid != nullptr && !solid->faces.empty()) ||
                       std::holds_alternative<physics::BallDefinition>(definition) ||
                       std::holds_alternative<physics::RingDefinition>(definition) ||
                       std::holds_alternative<physics::MeshDefinition>(definition);
  const int axis = side == Side::kLowX || side == Side::kHighX   ? 0
                   : side == Side::kLowY || side == Side::kHighY ? 1
                                                                 : 2;
  const double sign = side == Side::kHighX || side == Side::kHighY || side == Side::kHighZ ? 1 : -1;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Vector3d& place : rest) {
    least = std::min(least, sign * place[axis]);
    most = std::max(most, sign * place[axis]);
  }
  const double from = most - (isRound ? kShareOfRound : kShareOfFlat) * (most - least);
  std::vector<std::uint16_t> found;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (side == Side::kNone || sign * rest[i][axis] >= from) found.push_back(static_cast<std::uint16_t>(i));
  }
  return found;
}

std::size_t CountBodies(const Scene& scene) {
  std::size_t bodies = 0;
  for (const BodyGroup& group : scene.groups) {
    bodies += static_cast<std::size_t>(group.count[0]) * static_cast<std::size_t>(group.count[1]) *
              static_cast<std::size_t>(group.count[2]);
  }
  return bodies;
}

}  // namespace wobble::scenes
