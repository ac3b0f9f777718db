// A random world and its events: bodies dropped in heaps and columns onto ground of every kind, kicked, spun, steered,
// blown by wind and tilted.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/physics/world.h"
#include "server/scenes/blueprint_definition.h"
#include "tests/bench/random.h"

namespace wobble::bench {

// Length of a random trial, ticks: 10 s of play.
inline constexpr int kRandomTicks = 600;

// Heights on a square grid, as MakeHeightField takes them.
struct Terrain {
  int columns = 0;
  double cellSize = 0;  // m
  std::vector<double> heights;
};

class RandomWorld {
 public:
  RandomWorld(std::uint64_t seed, std::uint32_t number);

  // Applies the events that are due before the next step.
  void Act();

  [[nodiscard]] physics::World& Engine() { return *m_world; }
  [[nodiscard]] const physics::World& Engine() const { return *m_world; }
  // Shape and material of a blueprint, by its index in the world. What has been torn has a blueprint of its own, beyond
  // those that the world began with.
  [[nodiscard]] std::string Describe(std::uint8_t blueprint) const {
    return blueprint < m_descriptions.size() ? m_descriptions[blueprint] : "torn body";
  }
  [[nodiscard]] const std::string& Place() const { return m_place; }
  // What the blueprints were made from, and the terrain's heights; empty where there is none.
  [[nodiscard]] const std::vector<scenes::BlueprintDefinition>& Definitions() const { return m_definitions; }
  [[nodiscard]] const Terrain& ReadTerrain() const { return m_terrain; }
  [[nodiscard]] int Refused() const { return m_refused; }  // materials that Validate refused

 private:
  // A body that is steered like a player's.
  struct Player {
    physics::BodyId body = 0;
    int nextTick = 0;
  };

  void DrawBlueprints();
  void DrawGround();
  void AddSlopes();
  void AddTerrain();
  void PlaceBodies();
  void AddDrives();
  void Kick();
  void Steer(Player& player);

  Random m_random;
  std::unique_ptr<physics::World> m_world;
  std::vector<scenes::BlueprintDefinition> m_definitions;
  std::vector<std::string> m_descriptions;
  Terrain m_terrain;
  std::string m_place;
  int m_refused = 0;
  std::size_t m_mostVertices = 0;
  double m_floor = 0;        // height above everything on the ground, m
  double m_reach = 0;        // of the largest body, m
  std::vector<int> m_kicks;  // ticks
  std::vector<int> m_tilts;
  std::vector<Player> m_players;
};

}  // namespace wobble::bench
