// Two methods of games research, written for the laboratory from their papers, on the engine's equations.
#pragma once

#include <vector>

#include "tests/bench/precision_in_contact/soft_system.h"

namespace wobble::bench {

// Extended position-based dynamics in small steps (Macklin, Müller & Chentanez 2016; Macklin et al. 2019): one round of
// Gauss-Seidel a substep, multipliers begun at zero.
class Xpbd {
 public:
  explicit Xpbd(SoftSystem& system);
  // Steps by h s.
  void Step(double h);

 private:
  void SolveSprings(double h, const SoftSystem::OneBody& body);
  void SolveGas(double h, const SoftSystem::OneBody& body);
  void SolveTouch(double h, const Touch& touch);
  void Move(const Touch& touch, const physics::Vector3d& impulse);

  SoftSystem& m_system;
  std::vector<Touch> m_touches;
  std::vector<physics::Vector3d> m_gradient;
};

// Vertex block descent (Chen et al. 2024): implicit Euler's energy, lowered vertex by vertex by one Newton step each,
// for a fixed number of rounds, begun where inertia and weight would take the bodies. Left out of the paper: colours,
// which are for parallel processors, Chebyshev acceleration, and the starting point that adapts to the last step.
class BlockDescent {
 public:
  explicit BlockDescent(SoftSystem& system);
  // Steps by h s.
  void Step(double h, int rounds);

 private:
  // A spring as one of its ends sees it.
  struct HalfSpring {
    std::uint32_t other = 0;
    double restLength = 0;
    double stiffness = 0;
    double damping = 0;
  };
  // A touch as one of its points sees it.
  struct HalfTouch {
    std::uint32_t touch = 0;
    std::uint32_t place = 0;  // among the touch's points
  };
  // What the energy's slope and curvature at one vertex add up to.
  struct Block {
    physics::Vector3d force = physics::Vector3d::Zero();  // N
    Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  // N/m
  };

  void ListTouches();
  void DescendBody(double h, const SoftSystem::OneBody& body);
  void AddSprings(double h, std::size_t vertex, Block& block) const;
  void AddTouches(double h, std::size_t vertex, Block& block) const;

  SoftSystem& m_system;
  std::vector<std::size_t> m_springBegin;  // of each vertex, in m_springs
  std::vector<HalfSpring> m_springs;
  std::vector<Touch> m_touches;
  std::vector<std::vector<HalfTouch>> m_touchesOf;  // by vertex
  std::vector<physics::Vector3d> m_aim;             // where inertia and weight would take each vertex, m
};

}  // namespace wobble::bench
