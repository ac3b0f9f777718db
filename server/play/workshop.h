// The body that players build together from particles and springs, while it moves.
//
// Every change is checked at once, against what has been built so far, and shows in the world a few times a second:
// each is another blueprint, and that goes whole to everybody.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/world.h"
#include "server/play/command.h"
#include "server/scenes/play_rules.h"

namespace wobble::server {

// What a particle or a spring is called, and by whom it was made.
struct PartTag {
  std::uint16_t number = 0;  // its own as long as it is there
  ClientId owner = 0;        // 0: the scene has it
};

class Workshop {
 public:
  // body: of a graph.
  Workshop(const scenes::WorkshopRules& rules, physics::BodyId body, const physics::World& world);

  [[nodiscard]] physics::BodyId Body() const { return m_body; }
  // Why it cannot be done, for people; empty when it has been.
  [[nodiscard]] std::string Build(ClientId client, const BuildCommand& command, const physics::World& world);
  // Removes the springs that cross the blade.
  std::string Cut(const physics::Blade& blade, const physics::World& world);
  // Once a tick, before World::Step. True when the body has another blueprint now, and its vertices are others.
  bool Update(physics::World& world);

  // Of the body's vertices and springs as they are in the world.
  [[nodiscard]] std::span<const PartTag> Particles() const { return m_shownParticles; }
  [[nodiscard]] std::span<const PartTag> Springs() const { return m_shownSprings; }

 private:
  // The draft is what the world has.
  void NoteShown();
  // Those particles of the draft that are left, by their places in it.
  void KeepPlaces(std::span<const std::uint16_t> kept);
  // One that no part has.
  std::uint16_t FindNumber();
  // Adopts what an edit has made; or says why there is none.
  std::string Take(physics::GraphEdit&& edit, ClientId client);
  std::string AddParticle(ClientId client, const BuildCommand& command, const physics::World& world);
  std::string AddSpring(ClientId client, const BuildCommand& command, const physics::World& world);
  // Where the particles of the draft are, m: those in the world, then those on their way there.
  [[nodiscard]] std::vector<physics::Vector3d> FindPlaces(const physics::World& world) const;

  scenes::WorkshopRules m_rules;
  physics::BodyId m_body;
  physics::Blueprint m_draft;
  std::vector<PartTag> m_particles;      // of the draft
  std::vector<PartTag> m_springs;        // of the draft
  std::vector<std::uint16_t> m_kept;     // which vertex of the world's the draft's first ones are
  std::vector<physics::Vector3d> m_new;  // where those behind them are to appear, m
  std::vector<PartTag> m_shownParticles;
  std::vector<PartTag> m_shownSprings;
  bool m_changed = false;
  int m_changes = 0;         // since the last update
  double m_sinceUpdate = 0;  // s
  std::uint16_t m_lastNumber = 0;
};

}  // namespace wobble::server
