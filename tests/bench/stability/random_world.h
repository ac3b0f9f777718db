// A world drawn by chance and what happens in it: bodies dropped in heaps and columns onto ground of every kind,
// kicked, spun, steered, blown at and tilted.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/physics/world.h"
#include "tests/bench/random.h"

namespace wobble::bench {

// How hard bodies are dropped and kicked, and how much is heaped on them.
enum class Violence : std::uint8_t {
  kPlay,    // what they can bear: see random_world.cpp
  kBeyond,  // whatever that does to them
};

class RandomWorld {
 public:
  RandomWorld(std::uint64_t seed, std::uint32_t number, Violence violence);

  // Does what is due before the next step.
  void Act();

  [[nodiscard]] physics::World& Engine() { return *m_world; }
  [[nodiscard]] const physics::World& Engine() const { return *m_world; }
  // Of a blueprint by its place in the world: shape and material.
  [[nodiscard]] const std::string& Describe(std::uint8_t blueprint) const { return m_descriptions[blueprint]; }
  [[nodiscard]] const std::string& Place() const { return m_place; }
  [[nodiscard]] int Refused() const { return m_refused; }         // materials, by Validate
  [[nodiscard]] int Crushed() const { return m_crushed; }         // and those whose gas would not have carried them
  [[nodiscard]] double MostSpeed() const { return m_mostSpeed; }  // of drops and kicks, m/s

 private:
  // A body that is steered as a player would.
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

  // Whether every gas carries `mass`.
  [[nodiscard]] bool Carries(double mass) const;
  // Downwards, at least the Earth's, m/s²; 0 where it does not matter.
  [[nodiscard]] double FindLoad() const;

  Random m_random;
  Violence m_violence;
  std::unique_ptr<physics::World> m_world;
  std::vector<std::string> m_descriptions;
  std::string m_place;
  int m_refused = 0;
  int m_crushed = 0;
  std::size_t m_mostVertices = 0;
  double m_mostSpeed = 15;
  double m_floor = 0;        // height that nothing on the ground reaches, m
  double m_reach = 0;        // of the largest body, m
  std::vector<int> m_kicks;  // ticks
  std::vector<int> m_tilts;
  std::vector<Player> m_players;
};

}  // namespace wobble::bench
