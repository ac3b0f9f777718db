// Bodies in contact as the laboratory's own solvers step them: XPBD and vertex block descent.
//
// The forces are those of the engine, by its own numbers: springs and dashpots, gas, weight, penalty contacts with
// planes and between bodies. Contacts are found, followed and armed by the engine's functions, so that all methods
// solve the same equations and touch the same faces; how to step them is written here alone. Left out are what keeps
// the torque of friction between bodies exact (body_contact.h), a force of the order of depth over face; contacts of
// sharp edges; cores; and the tension of skins in one another.
//
// Double precision, world coordinates, plain code, one thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/skins/skin_gap.h"
#include "server/physics/world.h"

namespace wobble::bench {

// A contact that pushes, within one substep. Its depth and motion are linear in the positions of its points: with
// weights wᵢ, 1 for the vertex and minus the barycentric ones for the corners of a face,
//   depth = constant − normal · Σ wᵢ xᵢ,   motion of the vertex against what it touches = Σ wᵢ (xᵢ − beforeᵢ).
struct Touch {
  int count = 1;  // of points; 1: a plane
  std::array<std::uint32_t, 4> points{};
  std::array<double, 4> weights{};
  physics::Vector3d normal = physics::Vector3d::UnitZ();
  double constant = 0;  // m
  const physics::ContactParameters<double>* law = nullptr;
  double friction = 0;
  double share = 1;                                    // Coefficients::contactShares of the vertex
  bool sticks = false;                                 // has a stick spring
  physics::Vector3d slip = physics::Vector3d::Zero();  // its length when the substep began, m
};

// The force of a touch, and how it grows with motion against it in a substep of h s: stiffness plus damping over h.
struct TouchForce {
  double normal = 0;                                   // N, along Touch::normal
  double normalSlope = 0;                              // N/m
  physics::Vector3d pull = physics::Vector3d::Zero();  // friction, N; the vertex gets its opposite
  double pullSlope = 0;                                // N/m
};

class SoftSystem {
 public:
  struct OneBody {
    const physics::Blueprint* blueprint = nullptr;
    std::size_t begin = 0;  // of its vertices
    std::size_t end = 0;
    std::vector<physics::Contact<double>> contacts;
  };

  // Copies a world of double precision, which must outlive it, without contacts.
  explicit SoftSystem(const physics::World& world);

  // Lists the contacts that may act within a tick of `duration` s.
  void BeginTick(double duration);
  // Call with positions and velocities as they are after a substep of h s.
  void EndSubstep(double h);

  // The contacts that push with the vertices where they are.
  void FindTouches(std::vector<Touch>& touches) const;
  // h: of the substep, s.
  [[nodiscard]] TouchForce FindForce(const Touch& touch, double h) const;

  [[nodiscard]] std::span<const OneBody> Bodies() const { return m_bodies; }
  [[nodiscard]] const physics::Vector3d& Gravity() const { return m_gravity; }

  // One entry a vertex, body after body.
  std::vector<physics::Vector3d> x;       // m
  std::vector<physics::Vector3d> before;  // when the substep began, m
  std::vector<physics::Vector3d> v;       // m/s
  std::vector<double> inverseMasses;      // 1/kg; 0: fixed

 private:
  // Two bodies; sides[i]: contacts of vertices of bodies[i] with faces of the other.
  struct Pair {
    std::array<std::size_t, 2> bodies{};
    physics::ContactParameters<double> law;
    double gap = 0;  // m
    physics::PairSides<double> sides;
  };

  [[nodiscard]] std::span<const physics::Vector3d> Positions(const OneBody& body) const;
  [[nodiscard]] std::span<const physics::Vector3d> Velocities(const OneBody& body) const;
  [[nodiscard]] physics::Meeting<double> MakeMeeting(const Pair& pair, std::size_t side) const;
  void ListPair(double duration, Pair& pair) const;
  void ListSide(double duration, std::size_t side, Pair& pair) const;
  void AddPlaneTouches(const OneBody& body, std::vector<Touch>& touches) const;
  void AddBodyTouches(const Pair& pair, std::size_t side, std::vector<Touch>& touches) const;

  physics::Vector3d m_gravity;
  std::vector<physics::Surface<double>> m_surfaces;
  std::vector<OneBody> m_bodies;
  std::vector<Pair> m_pairs;
};

}  // namespace wobble::bench
