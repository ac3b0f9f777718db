// The body that players build together from particles and springs while it moves.
//
// Each change is checked at once against the draft, which holds all changes so far. The world takes over the draft at
// most every 0.2 s, because every new blueprint is sent whole to all clients.
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

// The name of a particle or spring, and who made it.
struct PartTag {
  std::uint16_t number = 0;  // unique among all parts as long as the part exists
  ClientId owner = 0;        // 0: the scene
};

class Workshop {
 public:
  // body: made from a graph blueprint; it stays in the world as long as the workshop.
  Workshop(const scenes::WorkshopRules& rules, physics::BodyId body, const physics::World& world);

  [[nodiscard]] physics::BodyId Body() const { return m_body; }
  // Whether builders may change only what they have built themselves.
  [[nodiscard]] bool IsProtected() const { return m_rules.isProtected; }
  void SetProtected(bool isProtected) { m_rules.isProtected = isProtected; }

  // mayChangeAll: whatever is protected.
  struct Builder {
    ClientId client = 0;
    bool mayChangeAll = false;
  };
  // Changes the draft. Returns an empty text, or the reason of a refusal, to be shown to the player.
  [[nodiscard]] std::string Build(const Builder& builder, const BuildCommand& command, const physics::World& world);
  // Removes the draft's springs that cross the blade and that the builder may change; returns as Build.
  std::string Cut(const Builder& builder, const physics::Blade& blade, const physics::World& world);
  // Makes the draft what the scene has; `home`: where the body's centre of mass is in the scene, m.
  void Reset(const physics::Vector3d& home);
  // Gives the body in the world the draft when that is due. Call it once a tick, before World::Step. Returns true when
  // the body has changed: its vertices are then numbered anew.
  bool Update(physics::World& world);

  // All that it remembers, to be stored.
  struct Memory {
    bool isProtected = false;
    physics::GraphParts draft;
    std::vector<PartTag> particles;
    std::vector<PartTag> springs;
    std::vector<std::uint16_t> kept;
    std::vector<physics::Vector3d> fresh;
    std::vector<PartTag> shownParticles;
    std::vector<PartTag> shownSprings;
    bool changed = false;
    int changes = 0;
    double sinceUpdate = 0;  // s
    std::uint16_t lastNumber = 0;
  };
  [[nodiscard]] Memory Read() const;
  // Goes on with what a workshop in this world remembered. Any memory is safe; returns false for one that cannot be of
  // this world.
  [[nodiscard]] bool Write(const Memory& memory, const physics::World& world);

  // Tags of the body's vertices and springs as they are in the world, in their order.
  [[nodiscard]] std::span<const PartTag> Particles() const { return m_shownParticles; }
  [[nodiscard]] std::span<const PartTag> Springs() const { return m_shownSprings; }

 private:
  // Tags all parts of the draft as the scene's.
  void TagAll();
  // Notes that the world has the draft.
  void NoteShown();
  [[nodiscard]] bool MayChange(const Builder& builder, const PartTag& part) const {
    return !m_rules.isProtected || builder.mayChangeAll || part.owner == builder.client;
  }
  // Whether the builder may change a particle and all springs that end in it, which go with it.
  [[nodiscard]] bool MayRemove(const Builder& builder, std::size_t particle) const;
  // Reduces m_kept and m_new to the particles that an edit keeps; kept: their old indices in the draft, ascending.
  void KeepPlaces(std::span<const std::uint16_t> kept);
  // A number that no part has.
  std::uint16_t FindNumber();
  // Adopts the result of an edit as the draft; returns as Build. client: the owner of a part that it has added.
  std::string Take(physics::GraphEdit&& edit, ClientId client);
  std::string AddParticle(ClientId client, const BuildCommand& command, const physics::World& world);
  std::string AddSpring(ClientId client, const BuildCommand& command, const physics::World& world);
  // The places of the draft's particles, m: first those in the world, then those that wait for the next update.
  [[nodiscard]] std::vector<physics::Vector3d> FindPlaces(const physics::World& world) const;

  scenes::WorkshopRules m_rules;
  physics::BodyId m_body;
  physics::Blueprint m_original;  // the scene's
  physics::Blueprint m_draft;
  std::vector<PartTag> m_particles;       // of the draft
  std::vector<PartTag> m_springs;         // of the draft
  std::vector<std::uint16_t> m_kept;      // the vertices in the world that are the draft's first particles
  std::vector<physics::Vector3d> m_new;   // places at which its other particles are to appear, m
  std::vector<PartTag> m_shownParticles;  // of the body in the world
  std::vector<PartTag> m_shownSprings;
  bool m_changed = false;    // the draft differs from the world
  int m_changes = 0;         // since the last update was due
  double m_sinceUpdate = 0;  // s
  std::uint16_t m_lastNumber = 0;
};

}  // namespace wobble::server
