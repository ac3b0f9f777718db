// A pack: bodies of one blueprint that are stepped by one sweep of vector instructions (kernels/sweep.h).
//
// The bodies' own states stay as they are, one vertex after the other: a pack is filled from them for a try of a tick
// and read back after it. That costs a few nanoseconds a vertex and leaves nothing to keep consistent when bodies wake,
// touch or change. Forces from outside the sweep (contacts, pushes) are found before each stage, at its positions, and
// wait for it in an array of their own. What a body does depends on nothing that the others of its pack do.
//
// How the numbers of the bodies lie in the lanes is the business of a layout, of which there are two: LaneLayout
// (lane_layout.h) has one body a lane, RowLayout (row_layout.h) a single body by the rows of its grid. The rest is the
// same for both and stands here, compiled for each: the layout is chosen when the pack is made, so that nothing in a
// stage asks for it. A Layout offers
//   Layout(const PackBodies<Real>&, kernels)
//   const SweepKernel<Real>& Kernel()
//   std::size_t Width()                    lanes of every vector
//   std::size_t CountPlaces()              places that each array of vertices has
//   std::size_t CountPending()             vectors of SweepLanes::pending
//   std::size_t CountWhole()               vectors of SweepLanes::whole; 0: it has none
//   PackSeat FindSeat(lane, vertex)        where a vertex of the pack's body `lane` lies
//   void Load(scratch, whole, lanes)       fills lanes.state from the bodies' states and `whole` from what has torn
//   void Sweep(stage, h, lanes)            one stage of a step of h s
//   SeatsOf(lane)                          a function from vertices to seats: FindSeat for one body
//   void CopyToSystem(numbers)             [place][x y z vx vy vz][lane] to the arrays of the bodies' system
//   void CopyToPoints(numbers)             the same to BodySystem::Points
//   bool IsInsideOut(lanes, lane)          whether the body's gas has no volume left
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "server/physics/kernels/kernels.h"
#include "server/physics/packs/pack_contacts.h"
#include "server/physics/packs/pack_planes.h"
#include "server/physics/step/body_system.h"

namespace wobble::physics {

// The bodies of a pack, all of one blueprint: members of a system, by their places there.
template <class Real>
struct PackBodies {
  const BodySystem<Real>& system;
  std::span<const std::uint32_t> whose;

  [[nodiscard]] Member<Real>& MemberIn(std::size_t lane) const { return *system.Members()[whose[lane]]; }
  // Unused lanes repeat the first body: that costs nothing, while numbers that are not finite would be slow.
  [[nodiscard]] Member<Real>& MemberOrFirst(std::size_t lane) const { return MemberIn(lane < whose.size() ? lane : 0); }
};

// The arrays of a pack. Reused from pack to pack to save allocations; one pack uses it at a time.
template <class Real>
struct PackScratch {
  struct alignas(64) Line {
    std::array<std::byte, 64> bytes;
  };
  std::vector<Line> lines;                 // all arrays that the sweep works on
  std::vector<std::uint8_t> hasOuter;      // SweepLanes::hasOuter
  std::vector<std::uint32_t> outerPlaces;  // the places where hasOuter is set
  GridRows<Real> tornRows;                 // RowLayout: coefficients of a body that has torn
  // Of one body: read and written by the laws that have no kernel (HasContactKernel).
  std::vector<Vector3<Real>> positions;
  std::vector<Vector3<Real>> velocities;
  std::vector<Vector3<Real>> forces;
  PackPlanes<Real> planes;
  PackContacts<Real> contacts;

  // Makes room for a pack of bodies with so many vertices each.
  void Reserve(std::size_t vertices);
};

// The kernel with the fewest lanes that has at least so many; the widest where none has. kernels: ascending by width.
template <class Real>
[[nodiscard]] const SweepKernel<Real>& FindNarrowest(std::span<const SweepKernel<Real>> kernels, std::size_t lanes) {
  return *std::find_if(kernels.begin(), kernels.end() - 1, [lanes](const SweepKernel<Real>& kernel) {
    return static_cast<std::size_t>(kernel.width) >= lanes;
  });
}

template <class Real, class Layout>
class Pack {
 public:
  // Fills the pack from the bodies' states. kernels: ascending by width.
  Pack(const PackBodies<Real>& bodies, std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch);

  // A stage, 0 to 3, of a step of h s has two halves. BeginStage computes the forces of static surfaces and of pushes
  // at the stage's positions; AddOuterForce may add others, N, on a vertex of the body in `lane`; Sweep computes the
  // rest and writes the next stage's positions.
  void BeginStage(int stage);
  void AddOuterForce(std::size_t lane, std::size_t vertex, const Vector3<Real>& force) {
    AddToSeat(m_layout.FindSeat(lane, vertex), force);
  }
  // The same for all forces on that body at once: visit(add) calls add(vertex, force) for each.
  template <class Visit>
  void AddOuterForces(std::size_t lane, const Visit& visit) {
    // Copies that no store can change: otherwise each force would make the compiler read the pointers again.
    const auto findSeat = m_layout.SeatsOf(lane);
    const std::uint8_t* const hasOuter = m_scratch.hasOuter.data();
    Real* const outer = m_outer;
    const std::size_t width = m_width;
    visit([=, this](std::size_t vertex, const Vector3<Real>& force) {
      const PackSeat seat = findSeat(vertex);
      if (hasOuter[seat.place] == 0) [[unlikely]]
        ClearOuter(seat.place);
      Real* const at = outer + 3 * seat.place * width + seat.lane;
      for (std::size_t k = 0; k < 3; ++k) at[k * width] += force[static_cast<int>(k)];
    });
  }
  void Sweep(int stage, Real h);
  // After stage 3: adds the step's share to the members' errors and updates the contacts with static surfaces.
  // step: s; timeLeft: of the tick when the step began, s; isFirst: this is the tick's first step.
  void EndStep(double step, double timeLeft, bool isFirst);

  // After the last step: writes positions and velocities to the system's arrays, contacts to the members' lists, and
  // Member::insideOut.
  void EndTry() const;

  // Copies the positions and velocities at which `stage` will be computed to the system's points, where contacts
  // between members read them. After stage 3 those of stage 0 are the next step's.
  void CopyToPoints(int stage) const { m_layout.CopyToPoints(NumbersOf(stage)); }

  [[nodiscard]] const PackBodies<Real>& Bodies() const { return m_bodies; }

 private:
  using Member = physics::Member<Real>;

  void LayOut();
  void LoadBodies();
  void LoadContacts();
  void AddPlaneForces(const Real* from);
  void AddRecoveryForces(std::size_t lane, const Real* from);
  // Lets add() fill in the scratch's forces from its positions and velocities, and hands them on. visit(use) calls
  // use(vertex) for each vertex that may get one; a vertex may come more than once.
  void AddPlainForces(std::size_t lane, const Real* from, const auto& visit, const auto& add);
  void AddPlainContactForces(std::size_t lane, const Real* from);
  void AddRodForces(std::size_t lane, const Real* from);
  void AddToSeat(const PackSeat& seat, const Vector3<Real>& force) {
    if (m_scratch.hasOuter[seat.place] == 0) ClearOuter(seat.place);
    Real* at = m_outer + 3 * seat.place * m_width + seat.lane;
    for (std::size_t k = 0; k < 3; ++k) at[k * m_width] += force[static_cast<int>(k)];
  }
  void ClearOuter(std::uint32_t place);
  void CopyVertex(std::size_t vertex, std::size_t lane, const Real* from);
  void AddErrors(const Real* sums, double weight);
  void UpdateAllAnchors(Real h);

  [[nodiscard]] const Real* NumbersOf(int stage) const { return stage == 0 ? m_lanes.state : m_lanes.stage; }

  PackBodies<Real> m_bodies;
  const Coefficients<Real>& m_body;
  Layout m_layout;
  ContactKernel<Real> m_contactKernel;
  PackScratch<Real>& m_scratch;
  std::size_t m_width;
  SweepLanes<Real> m_lanes;
  // The arrays that m_lanes shows the sweep as constant.
  Real* m_outer = nullptr;
  Real* m_acceleration = nullptr;
  Real* m_wind = nullptr;
  Real* m_whole = nullptr;
  Real* m_gas = nullptr;
  Real* m_stiffnessFactors = nullptr;
};

}  // namespace wobble::physics
