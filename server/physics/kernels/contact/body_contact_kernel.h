// The law and the update of body contacts on vectors (body_contact_lanes.h). Compiled once for each instruction set.
//
// Without branches: the force of a contact that does not act is computed with the others and not used. Divisors are
// kept above zero by bounds that no intact face or force comes near, so that a crushed face gives finite numbers.
#pragma once

#include "server/physics/kernels/contact/body_contact_lanes.h"
#include "server/physics/kernels/contact/contact_kernel.h"
#include "server/physics/kernels/contact/contact_limits.h"
#include "server/physics/lanes/lanes.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

// Lower bounds of divisors, m² and N: below them there is no direction.
inline constexpr float kLeastDoubleArea = 1e-30F;
inline constexpr float kLeastPull = 1e-30F;

template <class V>
struct Axes {
  V x, y, z;
};

template <class V>
WOBBLE_INLINE Axes<V> Subtract(const Axes<V>& a, const Axes<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
WOBBLE_INLINE Axes<V> Scale(V factor, const Axes<V>& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
// factor a + b
template <class V>
WOBBLE_INLINE Axes<V> AddScaled(V factor, const Axes<V>& a, const Axes<V>& b) {
  return {Fma(factor, a.x, b.x), Fma(factor, a.y, b.y), Fma(factor, a.z, b.z)};
}
// b - factor a
template <class V>
WOBBLE_INLINE Axes<V> SubtractScaled(const Axes<V>& b, V factor, const Axes<V>& a) {
  return {Fnma(factor, a.x, b.x), Fnma(factor, a.y, b.y), Fnma(factor, a.z, b.z)};
}
template <class V, class Mask>
WOBBLE_INLINE Axes<V> Choose(Mask first, const Axes<V>& a, const Axes<V>& b) {
  return {first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z};
}
template <class V>
WOBBLE_INLINE V Dot(const Axes<V>& a, const Axes<V>& b) {
  return Fma(a.z, b.z, Fma(a.y, b.y, a.x * b.x));
}
template <class V>
WOBBLE_INLINE Axes<V> Cross(const Axes<V>& a, const Axes<V>& b) {
  return {Fma(a.y, b.z, -(a.z * b.y)), Fma(a.z, b.x, -(a.x * b.z)), Fma(a.x, b.y, -(a.y * b.x))};
}

template <class V, class Real>
WOBBLE_INLINE V ReadRow(const ContactRow<Real>& row, std::size_t lane) {
  return *reinterpret_cast<const V*>(row + lane);
}
template <class V, class Real>
WOBBLE_INLINE Axes<V> ReadRows(const ContactRow<Real> (&rows)[3], std::size_t lane) {
  return {ReadRow<V>(rows[0], lane), ReadRow<V>(rows[1], lane), ReadRow<V>(rows[2], lane)};
}
template <class V, class Real>
WOBBLE_INLINE void WriteRow(V value, ContactRow<Real>& row, std::size_t lane) {
  *reinterpret_cast<V*>(row + lane) = value;
}
template <class V, class Real>
WOBBLE_INLINE void WriteRows(const Axes<V>& value, ContactRow<Real> (&rows)[3], std::size_t lane) {
  WriteRow(value.x, rows[0], lane);
  WriteRow(value.y, rows[1], lane);
  WriteRow(value.z, rows[2], lane);
}

// Σ wᵢ aᵢ over a face's corners.
template <class V>
WOBBLE_INLINE Axes<V> BlendOf(const Axes<V>& weights, const Axes<V>& a, const Axes<V>& b, const Axes<V>& c) {
  return AddScaled(weights.z, c, AddScaled(weights.y, b, Scale(weights.x, a)));
}

// FacePoint of face_search.h: the vertex p seen from its face (a, b, c).
template <class V>
struct FaceView {
  Axes<V> p, a, b, c, ab, ac;
  Axes<V> normal, weights;
  V distance, inverseArea;
};

template <class V, class Real>
WOBBLE_INLINE FaceView<V> ViewFace(const BodyContactBlock<Real>& block, const BodyContactPoints<Real>& points,
                                   std::size_t lane) {
  const V one = Spread<V>(Real(1));
  FaceView<V> at;
  at.p = AddScaled(one, ReadRows<V, Real>(block.shift, lane), ReadRows<V, Real>(points.x[0], lane));
  at.a = ReadRows<V, Real>(points.x[1], lane);
  at.b = ReadRows<V, Real>(points.x[2], lane);
  at.c = ReadRows<V, Real>(points.x[3], lane);
  at.ab = Subtract(at.b, at.a);
  at.ac = Subtract(at.c, at.a);
  const Axes<V> ap = Subtract(at.p, at.a);
  const Axes<V> area = Cross(at.ab, at.ac);
  at.inverseArea = one / Max(Sqrt(Dot(area, area)), Spread<V>(Real(kLeastDoubleArea)));
  const Axes<V> normal = Scale(at.inverseArea, area);
  at.weights.y = Dot(Cross(ap, at.ac), normal) * at.inverseArea;
  at.weights.z = Dot(Cross(at.ab, ap), normal) * at.inverseArea;
  at.weights.x = one - at.weights.y - at.weights.z;
  at.normal = Scale(ReadRow<V>(block.side, lane), normal);
  at.distance = Dot(ap, at.normal) - ReadRow<V>(block.offset, lane);
  return at;
}

// The velocity of the vertex against its foot on the face.
template <class V, class Real>
WOBBLE_INLINE Axes<V> FindVelocity(const FaceView<V>& at, const BodyContactPoints<Real>& points, std::size_t lane) {
  return Subtract(ReadRows<V, Real>(points.v[0], lane),
                  BlendOf(at.weights, ReadRows<V, Real>(points.v[1], lane), ReadRows<V, Real>(points.v[2], lane),
                          ReadRows<V, Real>(points.v[3], lane)));
}

// The stick spring, m, whether the contact has one or not.
template <class V, class Real>
WOBBLE_INLINE Axes<V> FindStickSlip(const FaceView<V>& at, const BodyContactBlock<Real>& block, std::size_t lane) {
  const Axes<V> moved = Subtract(at.p, BlendOf(ReadRows<V, Real>(block.foot, lane), at.a, at.b, at.c));
  const Axes<V> slip = AddScaled(Spread<V>(Real(1)), ReadRows<V, Real>(block.slip, lane), moved);
  return SubtractScaled(slip, Dot(slip, at.normal), at.normal);
}

// FindFirstSlip of contact.h.
template <class V, class Real>
WOBBLE_INLINE Axes<V> FindFirstSlip(const FaceView<V>& at, const Axes<V>& velocity, V away, V depth, Real h) {
  const V time = Min(Spread<V>(h), depth / Max(-away, Spread<V>(Real(kLeastPull))));
  return Scale(time, SubtractScaled(velocity, away, at.normal));
}

template <class V, class Real>
WOBBLE_INLINE PenaltyLaw<V> ReadLaw(const BodyContactBlock<Real>& block, std::size_t lane) {
  return {.stiffness = ReadRow<V>(block.stiffness, lane),
          .fadeDepth = ReadRow<V>(block.fadeDepth, lane),
          .perFadeDepth = ReadRow<V>(block.perFadeDepth, lane),
          .damping = ReadRow<V>(block.damping, lane),
          .stickDamping = ReadRow<V>(block.stickDamping, lane)};
}

template <class V>
WOBBLE_INLINE V FindLeast(const Axes<V>& a) {
  return Min(a.x, Min(a.y, a.z));
}

// The forces on the corners, derived in ComputeBodyContacts. force: on the vertex.
template <class V, class Real>
WOBBLE_INLINE void PushCorners(const FaceView<V>& at, const BodyContactBlock<Real>& block, const Axes<V>& pull,
                               const Axes<V>& force, std::size_t lane, BodyContactForces<Real>& forces) {
  const V one = Spread<V>(Real(1));
  const Axes<V> sides[3] = {Subtract(at.c, at.b), Subtract(at.a, at.c), at.ab};
  const V square = Max(Dot(sides[0], sides[0]), Max(Dot(sides[1], sides[1]), Dot(sides[2], sides[2])));
  const V most = one / Max(Sqrt(square), Spread<V>(Real(kLeastDoubleArea)));
  const V below = -(at.distance + ReadRow<V>(block.offset, lane));  // the face itself, m
  const V lever = Max(-most, Min(below * at.inverseArea, most));
  const V winding = ReadRow<V>(block.side, lane);
  const Axes<V> turned = Scale(winding * ReadRow<V>(block.share, lane) * lever, Cross(pull, at.normal));
  const V weights[3] = {at.weights.x, at.weights.y, at.weights.z};
  for (int i = 0; i < 3; ++i) {
    WriteRows<V, Real>(SubtractScaled(Scale(Dot(turned, sides[i]), at.normal), weights[i], force), forces.onCorners[i],
                       lane);
  }
}

template <class V, class Real>
void ComputeBodyContactForces(const BodyContactBlock<Real>& block, const BodyContactPoints<Real>& points,
                              BodyContactForces<Real>& forces) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(Real);
  const V zero = Spread<V>(Real(0));
  forces.acts = 0;
  forces.left = 0;
  for (std::size_t lane = 0; lane < kContactsInBlock; lane += kWidth) {
    const FaceView<V> at = ViewFace<V>(block, points, lane);
    const V maxDepth = ReadRow<V>(block.maxDepth, lane);
    const V depth = -(at.distance + ReadRow<V>(block.leap, lane));
    const std::uint32_t left = FindBelow(FindLeast(at.weights), zero) & FindBelow(zero, maxDepth);
    const std::uint32_t acts = FindBelow(zero, depth) & FindBelow(depth, maxDepth) & ~left;
    forces.left |= left << lane;
    forces.acts |= acts << lane;
    if (acts == 0) continue;
    const Axes<V> velocity = FindVelocity(at, points, lane);
    const V away = Dot(at.normal, velocity);
    const PenaltyLaw<V> law = ReadLaw<V>(block, lane);
    const V spring = FindSpringForce<Real>(law, depth);
    const V normalForce = FindNormalForce<Real>(law, spring, depth, -away);
    const V friction = ReadRow<V>(block.friction, lane);
    const Axes<V> slip = FindStickSlip(at, block, lane);
    const V stick = LimitStick(ReadRow<V>(block.touching, lane) * ReadRow<V>(block.stickStiffness, lane),
                               Dot(slip, slip), friction * spring);
    const Axes<V> drag = Scale(law.stickDamping, SubtractScaled(velocity, away, at.normal));
    const Axes<V> pull = AddScaled(stick, slip, drag);
    const V limit = friction * normalForce;
    const V strength = Max(Sqrt(Dot(pull, pull)), Spread<V>(Real(kLeastPull)));
    const Axes<V> kept = Scale(Min(limit / strength, Spread<V>(Real(1))), pull);
    const V share = ReadRow<V>(block.share, lane);
    const Axes<V> force = Scale(share, Subtract(Scale(normalForce, at.normal), kept));
    WriteRows<V, Real>(force, forces.onVertex, lane);
    PushCorners(at, block, kept, force, lane, forces);
  }
}

// The neighbour across one side (from, to) as seen from p, whose foot is on its own face. nearer: the neighbour rises
// so far that it may be nearer (IsPlainlyNearest of face_search.cpp); slides: p has slid over the side (SlidesOver, for
// a weight that is not negative). One bit a lane.
struct SideView {
  std::uint32_t nearer;
  std::uint32_t slides;
};
template <class V, class Real>
WOBBLE_INLINE SideView ViewSide(const FaceView<V>& at, const Axes<V>& from, const Axes<V>& to, const Axes<V>& beyond,
                                V side, V offset) {
  const Axes<V> area = Cross(Subtract(from, to), Subtract(beyond, to));
  const V inverse = side / Max(Sqrt(Dot(area, area)), Spread<V>(Real(kLeastDoubleArea)));
  const Axes<V> normal = Scale(inverse, area);
  const V distance = Dot(Subtract(at.p, to), normal) - offset;
  const std::uint32_t concave = FindBelow(Spread<V>(Real(0)), Dot(Subtract(beyond, at.a), at.normal));
  const std::uint32_t rises = FindBelow(at.distance, distance);
  const std::uint32_t smooth = FindBelow(Spread<V>(static_cast<Real>(kSmoothCosine)), Dot(at.normal, normal));
  return {concave & FindBelow(distance, at.distance), rises & smooth & ~concave};
}

// The contacts that may leave their face, or that are not armed: the vertex is beside the face or slides off it, the
// face looks along the normal of the vertex's own skin, or the vertex is neither inside nor in the gap and a neighbour
// may be nearer. All others keep their face for certain.
template <class V, class Real>
WOBBLE_INLINE std::uint32_t FindThoseThatMove(const FaceView<V>& at, const BodyContactBlock<Real>& block,
                                              const BodyContactPoints<Real>& points, std::size_t lane) {
  const V zero = Spread<V>(Real(0));
  const V side = ReadRow<V>(block.side, lane);
  const V offset = ReadRow<V>(block.offset, lane);
  const Axes<V>* corners[3] = {&at.a, &at.b, &at.c};
  SideView all{0, 0};
  for (int i = 0; i < 3; ++i) {
    const SideView one = ViewSide<V, Real>(at, *corners[(i + 1) % 3], *corners[(i + 2) % 3],
                                           ReadRows<V, Real>(points.across[i], lane), side, offset);
    all = {all.nearer | one.nearer, all.slides | one.slides};
  }
  const Axes<V> outward = ReadRows<V, Real>(block.outward, lane);
  const std::uint32_t hasOutward = FindBelow(zero, Dot(outward, outward));
  const std::uint32_t along = FindBelow(Spread<V>(static_cast<Real>(kFacingCosine)), Dot(at.normal, outward));
  const std::uint32_t inside = FindBelow(at.distance, zero - offset);
  const std::uint32_t isOpen = FindBelow(zero, ReadRow<V>(block.open, lane));
  const std::uint32_t inGap =
      (isOpen | hasOutward) & FindBelow(at.distance, zero);  // IsInGap of body_contact_update.cpp
  return FindBelow(FindLeast(at.weights), zero) | (all.nearer & ~inside & ~inGap) | all.slides | (hasOutward & along) |
         FindBelow(ReadRow<V>(block.maxDepth, lane), zero);
}

// HasLeaptBehind of body_contact_update.cpp, for a contact that keeps its face.
template <class V, class Real>
WOBBLE_INLINE std::uint32_t FindThoseThatLeapt(const FaceView<V>& at, const BodyContactBlock<Real>& block, V speed,
                                               V reach, std::size_t lane) {
  const V zero = Spread<V>(Real(0));
  const V offset = ReadRow<V>(block.offset, lane);
  const V depth = ReadRow<V>(block.depth, lane);
  const V before = depth + ReadRow<V>(block.leap, lane) - offset;
  const V behind = -at.distance - offset;
  const V play = Fma(reach, speed, ReadRow<V>(block.maxDepth, lane) - Max(zero, depth));
  return FindBelow(zero, ReadRow<V>(block.open, lane)) & FindBelow(zero, behind) & ~FindBelow(zero, before) &
         FindBelow(play, behind - before);
}

// NoteLeap of body_contact_update.cpp, for a contact that keeps its face.
template <class V, class Real>
WOBBLE_INLINE V FindLeap(const FaceView<V>& at, const BodyContactBlock<Real>& block, V speed, V away, V reach,
                         std::size_t lane) {
  const V zero = Spread<V>(Real(0));
  const V depth = -at.distance;
  const V approach = Max(zero, -away);
  const V counts = Fma(ReadRow<V>(block.open, lane), speed - approach, approach);
  const V most = Fma(reach, counts, ReadRow<V>(block.depth, lane) + ReadRow<V>(block.freeDepth, lane));
  const V before = ReadRow<V>(block.leap, lane);
  const V isHeld = ReadRow<V>(block.open, lane) * ReadRow<V>(block.touching, lane);
  const V leap = before + Max(zero, Fnma(isHeld, depth, depth - before - most));
  return Min(Max(leap, zero), Max(zero, depth));
}

template <class V, class Real>
BodyContactChange UpdateBodyContactBlock(const BodyContactPoints<Real>& points, Real h, BodyContactBlock<Real>& block) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(Real);
  constexpr std::uint32_t kAll = (1U << kWidth) - 1;
  const V zero = Spread<V>(Real(0));
  const V one = Spread<V>(Real(1));
  const V reach = Spread<V>(static_cast<Real>(kArmingSteps) * h);
  BodyContactChange change;
  for (std::size_t lane = 0; lane < kContactsInBlock; lane += kWidth) {
    const FaceView<V> at = ViewFace<V>(block, points, lane);
    change.left |= FindThoseThatMove(at, block, points, lane) << lane;
    const Axes<V> velocity = FindVelocity(at, points, lane);
    const V speed = Sqrt(Dot(velocity, velocity));
    change.left |= FindThoseThatLeapt(at, block, speed, reach, lane) << lane;
    const V away = Dot(at.normal, velocity);
    const V leap = FindLeap(at, block, speed, away, reach, lane);
    const V depth = -(at.distance + leap);
    const V inside = Max(zero, depth);
    const std::uint32_t open = FindBelow(zero, ReadRow<V>(block.open, lane));
    const std::uint32_t armed = open | (kAll & ~FindBelow(ReadRow<V>(block.maxDepth, lane), inside));
    // At least the depth itself, so an armed contact pushes wherever it is inside.
    const V maxDepth = inside + Fma(reach, speed, Spread<V>(static_cast<Real>(kArmingDepth)));
    const std::uint32_t touching = armed & FindBelow(zero, depth);
    const V wasTouching = ReadRow<V>(block.touching, lane);
    Axes<V> slip = Scale(wasTouching, FindStickSlip(at, block, lane));
    if ((FindBelow(wasTouching, one) & FindBelow(zero, inside)) != 0) {
      slip = Choose(wasTouching < one, FindFirstSlip(at, velocity, away, inside, h), slip);
    }
    const V limit = ReadRow<V>(block.friction, lane) * FindSpringForce<Real>(ReadLaw<V>(block, lane), inside);
    const V strength = ReadRow<V>(block.stickStiffness, lane) * Sqrt(Dot(slip, slip));
    const V kept = Min(limit / Max(strength, Spread<V>(Real(kLeastPull))), one);
    // Adding +0 takes the sign from a zero: whose sign a lane that is not inside gets depends on the others of its
    // block, and so on the width.
    WriteRows<V, Real>(AddScaled(kept, slip, Axes<V>{zero, zero, zero}), block.slip, lane);
    WriteRows<V, Real>(at.weights, block.foot, lane);
    WriteRow(leap, block.leap, lane);
    WriteRow(depth, block.depth, lane);
    WriteRow(maxDepth, block.maxDepth, lane);
    change.armed |= armed << lane;
    change.touching |= touching << lane;
  }
  return change;
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
