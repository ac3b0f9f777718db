// Pulls skins that intersect out of one another.
//
// Contacts keep skins apart as long as each vertex is on the right side of what it meets. Where two edges have crossed,
// a hit was harder than contacts are stiff, or a body was put into another, none of them knows the way out. What tells
// it is the contour: the lines along which triangles of the two skins intersect. Its length L is 0 where nothing
// intersects, so it is given a tension σ, the energy E = σL and the force −σ∇L (contour minimization: Volino &
// Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour minimization"; their direction is
// made symmetric, here it is the gradient itself).
//
// The contour is a polygon. Each of its corners is the point P at which a side of one skin, with direction E, passes
// through a face of the other, with normal N, and a segment begins there along each face at that side, in the
// direction Rᵢ in which the face lies. With displacements d of the side's point and e of the face's, P stays on both:
//   δP = d − E (N·(d − e))/(E·N),   δL = −Σ Rᵢ·δP,
// so with R = Σ Rᵢ and c = (R·E)/(E·N) the side's point gets the force σ(R − cN) and the face's σcN, each shared out by
// barycentric weights. L does not change when all is moved or turned, so momentum and angular momentum stay as they
// are: R adds up to zero over the two ends of every segment. c is bounded, since a side that lies in a face has no
// E·N; that changes neither sum.
//
// The forces are those of the positions as a tick begins, and constant through it. A free vertex of mass m would so go
// by ½ (σ/m) t² in a tick of t; σ = m a, a = ω² l with the mean length l of the sides, moves it by a share of l:
//   ω = 30/s, and at most 1/2t, so that this share is at most an eighth; and a at most 150 m/s².
// Without the last, sheets with sides of half a metre got energy from nowhere (one of 1,000 random worlds). In a body
// that vibrates faster than a tick the contour is another one when the tick ends, and the force heats it like noise: of
// 10,000 random worlds one cloth without damping, tangled for good, got to 860 m/s. So where the fastest vertex of
// either body goes at u against the body as a whole, σ is divided by 1 + (u/u₀)², u₀ = 10 m/s.
//
// The tension grows within 0.1 s, but where contacts do better alone it waits for 1 s and grows within 4 s:
// - Two closed bodies know inside from outside, and their contacts part nearly all that have met hard; planar bodies
//   cannot give way across their plane. At once, it made balls of players who chase one another dent one another: three
//   times as many pairs of triangles intersected, and they took twice the substeps.
// - Bodies that move against one another at more than 10 m/s: a contour is as short where a body is nearly through a
//   sheet as where it is nearly out, but there contacts remember the side (one of 200 shots at sheets passed).
// - A closed body and an open skin below 5 m/s. Edges of a coarse ball dip through faces of a sheet for some ticks,
//   each vertex on its right side; a force that sets in each time is a jump for the step. Balls that dropped on a sheet
//   were off by 402 mm after a second instead of 31 (15 without any tension), and a ball on a cloth missed its error
//   target in 21 of 48 seconds instead of 5. After hard hits the tension is needed: without it, a shot passed through
//   a sheet. The speed is that of the tick, so a body that a sheet has slowed below 5 m/s is left to its contacts
//   again.
//
// Contacts that remember a wrong side may be stronger than the tension. So those of two sheets, and of planar bodies,
// forget it after 0.15 s in one another (PairSearch::ForgetSides).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/model/bounds.h"

namespace wobble::physics {

// Whether two skins have been found in one another.
struct Tangle {
  int ticks = 0;      // in a row so far, as far as is known
  int untilLook = 0;  // ticks
};
inline constexpr int kMostTangleTicks = 1 << 20;
inline constexpr int kMostTicksUntilLook = 29;

// A body whose skin may be in another's: one with faces.
template <class Real>
struct TangledSkin {
  const Blueprint* blueprint = nullptr;
  std::span<const Vector3<Real>> x;      // local coordinates, m
  Bounds<Real> bounds;                   // of x
  Vector3d velocity = Vector3d::Zero();  // of the body as a whole, m/s
  double agitation = 0;                  // Survey::agitation, m/s
};

// Kept by the caller to save allocations.
struct UntanglingScratch {
  struct Triangle {
    Eigen::AlignedBox3d box;
    std::array<Vector3d, 3> corners;  // m, in the coordinates of the first body
    Vector3d doubleArea;              // m², along the normal
    std::uint16_t face = 0;
    std::uint8_t body = 0;  // 0 or 1
  };
  std::vector<std::uint8_t> beside;  // by vertex of a body: a bit for each bound that it is beyond
  std::vector<Triangle> near;
  std::array<std::vector<Vector3d>, 2> forces;  // by vertex of the first and the second body, N
};

// By body.
template <class Real>
using Pulls = std::array<std::vector<VertexForce<Real>>, 2>;

// Looks, if it is time to, whether two skins intersect, or the layers of one (the same skin twice), and replaces
// `pulls` by the forces that take them apart; those of a body on itself are in pulls[0]. shift: from the origin of the
// first body to that of the second, m. tick: s. Cost: a pass over the vertices and faces of both where their boxes
// overlap, and a test of each two of the faces there that are beside one another.
template <class Real>
void Untangle(const TangledSkin<Real>& first, const TangledSkin<Real>& second, const Vector3d& shift, double tick,
              UntanglingScratch& scratch, Tangle& tangle, Pulls<Real>& pulls);

}  // namespace wobble::physics
