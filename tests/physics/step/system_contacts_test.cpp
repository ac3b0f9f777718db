// Tests the kernels of system_contacts.h and of the contact search against plain code, and every width against every
// other.
#include "server/physics/step/system_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "server/physics/kernels/kernels.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/skins/body_contact_search.h"
#include "server/physics/skins/body_contact_update.h"
#include "server/physics/step/member.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kTick = 1.0 / 60;

template <class Real>
std::vector<Vector3<Real>> Shake(std::size_t count, double amplitude, double phase) {
  std::vector<Vector3<Real>> values;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = phase + static_cast<double>(i);
    values.push_back(
        Vector3d(amplitude * Vector3d(std::sin(1.3 * at), std::cos(2.1 * at), std::sin(0.7 * at))).cast<Real>());
  }
  return values;
}

template <class Real>
SkinPoints<Real> ReadSkin(const Member<Real>& member) {
  SkinPoints<Real> points;
  points.Read({member.blueprint->template Read<Real>().faces, &member.blueprint->topology, member.state->positions},
              member.state->velocities);
  return points;
}

// Two balls pressed flat on one another and on a cloth, all shaken.
template <class Real>
struct Pile {
  std::vector<Blueprint> blueprints;
  std::vector<State<Real>> states;
  std::vector<Member<Real>> members;
  std::vector<Member<Real>*> pointers;
  std::vector<std::array<std::vector<BodyContact<Real>>, 2>> lists;
  std::vector<ContactPair<Real>> contactPairs;
  std::vector<std::vector<MovingPoint<Real>>> points;

  explicit Pile(const PointKernel<Real>& kernel) {
    blueprints.push_back(MakeBall(MakeMeasuredBall()));
    ClothDefinition cloth;
    cloth.points = {12, 12};
    cloth.orientation = Orientation::kHorizontal;
    blueprints.push_back(MakeCloth(cloth));
    const Vector3d down(0, 0, -1);
    states.push_back(MakeState<Real>(blueprints[0], {0, 0, 0}, Vector3d::Zero()));
    states.push_back(MakeState<Real>(blueprints[0], {0.1, 0.2, 1.595}, down));
    states.push_back(MakeState<Real>(blueprints[1], {0.1, 0, -0.797}, -down));
    members.resize(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto shaken = Shake<Real>(states[i].positions.size(), 0.005, static_cast<double>(i));
      for (std::size_t k = 0; k < shaken.size(); ++k) {
        Real& height = states[i].positions[k][2];
        height = std::clamp(height, Real(-0.8), Real(0.8));
        states[i].positions[k] += shaken[k];
      }
      for (std::size_t k = 0; k < shaken.size(); ++k) states[i].velocities[k] += Real(30) * shaken[k];
      members[i].blueprint = &blueprints[i / 2];
      members[i].state = &states[i];
      members[i].survey =
          MakeSurvey<Real>(blueprints[i / 2].Read<Real>().masses, states[i].positions, states[i].velocities);
      pointers.push_back(&members[i]);
    }
    lists.resize(2);
    for (std::uint32_t pair = 0; pair < 2; ++pair) Meet(pair, kernel);
  }

  void Meet(std::uint32_t pair, const PointKernel<Real>& kernel) {
    const std::array<std::uint32_t, 2> both{0, pair + 1};
    const auto parameters = Combine(members[both[0]].blueprint->template Read<Real>().contact,
                                    members[both[1]].blueprint->template Read<Real>().contact);
    ContactSearchScratch<Real> scratch;
    for (std::size_t side = 0; side < 2; ++side) {
      const Member<Real>& vertices = members[both[side]];
      const Member<Real>& faces = members[both[1 - side]];
      const SkinPoints<Real> own = ReadSkin(vertices);
      const SkinPoints<Real> skin = ReadSkin(faces);
      Bounds<Real> near = faces.survey.bounds;
      near.low.array() -= Real(0.1);
      near.high.array() += Real(0.1);
      near.speed += vertices.survey.bounds.speed;
      FindBodyContacts<Real>(
          parameters, MakeMeeting<Real>(vertices, faces, 0),
          {vertices.blueprint->template Read<Real>().faces, &vertices.blueprint->topology, vertices.state->positions},
          {.vertices = &own,
           .skin = &skin,
           .kernel = kernel,
           .near = near,
           .margin = Real(0.02),
           .duration = static_cast<Real>(kTick)},
          lists[pair][side], scratch);
    }
    contactPairs.push_back({.members = both, .parameters = parameters, .sides = {&lists[pair][0], &lists[pair][1]}});
  }

  std::vector<Motion<Real>> Motions() const {
    std::vector<Motion<Real>> motions;
    for (const State<Real>& state : states) motions.push_back({state.positions, state.velocities});
    return motions;
  }

  // The same, with positions and velocities side by side as packs leave them. Valid until the next call.
  std::vector<Motion<Real>> MotionsOfPoints() {
    points.resize(states.size());
    std::vector<Motion<Real>> motions;
    for (std::size_t i = 0; i < states.size(); ++i) {
      points[i].clear();
      for (std::size_t k = 0; k < states[i].positions.size(); ++k) {
        points[i].push_back({.x = states[i].positions[k], .v = states[i].velocities[k]});
      }
      const MovingPoint<Real>* const first = points[i].data();
      motions.push_back({{&first->x, sizeof *first}, {&first->v, sizeof *first}, first});
    }
    return motions;
  }

  // Moves all vertices by as much as a substep might.
  void Move(double phase) {
    for (State<Real>& state : states) {
      const auto moved = Shake<Real>(state.positions.size(), 0.004, phase);
      for (std::size_t k = 0; k < moved.size(); ++k) state.positions[k] += moved[k];
    }
  }

  std::size_t CountContacts() const {
    std::size_t count = 0;
    for (const auto& pair : lists) count += pair[0].size() + pair[1].size();
    return count;
  }

  std::vector<std::vector<Vector3<Real>>> MakeSums() const {
    std::vector<std::vector<Vector3<Real>>> sums;
    for (const State<Real>& state : states) sums.emplace_back(state.positions.size(), Vector3<Real>::Zero());
    return sums;
  }

  std::vector<std::vector<Vector3<Real>>> AddUp(const SystemContacts<Real>& contacts) const {
    auto sums = MakeSums();
    for (std::size_t i = 0; i < sums.size(); ++i) {
      contacts.VisitForcesOn(i, [&](std::size_t vertex, const Vector3<Real>& force) { sums[i][vertex] += force; });
    }
    return sums;
  }

  std::vector<std::vector<Vector3<Real>>> AddUpPlainly() const {
    auto sums = MakeSums();
    for (const ContactPair<Real>& contactPair : contactPairs) {
      for (std::size_t side = 0; side < 2; ++side) {
        const std::uint32_t vertices = contactPair.members[side];
        const std::uint32_t faces = contactPair.members[1 - side];
        std::vector<ContactForce<Real>> forces(contactPair.sides[side]->size());
        ComputeBodyContacts<Real>(contactPair.parameters,
                                  MakeMeeting<Real>(members[vertices], members[faces], contactPair.gap),
                                  *contactPair.sides[side], forces);
        AddToVertices<Real>(forces, [&](std::uint16_t i, const Vector3<Real>& force) { sums[vertices][i] += force; });
        AddToCorners<Real>(forces, [&](std::uint16_t i, const Vector3<Real>& force) { sums[faces][i] += force; });
      }
    }
    return sums;
  }

  void UpdatePlainly(Real h) {
    for (const ContactPair<Real>& contactPair : contactPairs) {
      for (std::size_t side = 0; side < 2; ++side) {
        UpdateBodyContacts<Real>(contactPair.parameters,
                                 MakeMeeting<Real>(members[contactPair.members[side]],
                                                   members[contactPair.members[1 - side]], contactPair.gap),
                                 h, *contactPair.sides[side]);
      }
    }
  }
};

template <class Real>
void ExpectTheSame(const BodyContact<Real>& a, const BodyContact<Real>& b, Real tolerance) {
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.face, b.face);
  EXPECT_EQ(a.phase, b.phase);
  EXPECT_EQ(a.side, b.side);
  EXPECT_NEAR(a.maxDepth, b.maxDepth, tolerance);
  EXPECT_NEAR(a.depth, b.depth, tolerance);
  EXPECT_NEAR(a.leap, b.leap, tolerance);
  EXPECT_LE((a.foot - b.foot).norm(), 30 * tolerance);
  EXPECT_LE((a.slip - b.slip).norm(), tolerance);
}

template <class Real>
void ExpectTheSame(const Pile<Real>& a, const Pile<Real>& b, Real tolerance) {
  for (std::size_t pair = 0; pair < a.lists.size(); ++pair) {
    for (std::size_t side = 0; side < 2; ++side) {
      ASSERT_EQ(a.lists[pair][side].size(), b.lists[pair][side].size());
      for (std::size_t i = 0; i < a.lists[pair][side].size(); ++i) {
        ExpectTheSame(a.lists[pair][side][i], b.lists[pair][side][i], tolerance);
      }
    }
  }
}

template <class Real>
class SystemContactsTest : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(SystemContactsTest, Precisions);

TYPED_TEST(SystemContactsTest, TheKernelDoesWhatThePlainCodeDoes) {
  using Real = TypeParam;
  const Real epsilon = std::numeric_limits<Real>::epsilon();
  for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
    Pile<Real> inLanes(kernel.points);
    Pile<Real> plain(kernel.points);
    ASSERT_GT(inLanes.CountContacts(), 60U);
    SystemContacts<Real> contacts;
    contacts.Build(inLanes.contactPairs, inLanes.pointers, kernel.bodyContacts);
    for (int substep = 0; substep < 4; ++substep) {
      contacts.ComputeForces(inLanes.Motions(), nullptr);
      const auto forces = inLanes.AddUp(contacts);
      const auto expected = plain.AddUpPlainly();
      Real largest = 0;
      for (std::size_t i = 0; i < forces.size(); ++i) {
        for (const Vector3<Real>& force : expected[i]) largest = std::max(largest, force.norm());
      }
      ASSERT_GT(largest, Real(1)) << "substep " << substep;
      for (std::size_t i = 0; i < forces.size(); ++i) {
        for (std::size_t k = 0; k < forces[i].size(); ++k) {
          ASSERT_LE((forces[i][k] - expected[i][k]).norm(), 2000 * epsilon * largest) << "substep " << substep;
        }
      }
      inLanes.Move(substep);
      plain.Move(substep);
      contacts.Update(inLanes.Motions(), static_cast<Real>(kTick / 4), nullptr);
      plain.UpdatePlainly(static_cast<Real>(kTick / 4));
      ExpectTheSame(inLanes, plain, 200 * epsilon);
    }
  }
}

TYPED_TEST(SystemContactsTest, EveryWidthGivesTheSameBitsWhereverPointsLie) {
  using Real = TypeParam;
  const auto kernels = FindSweepKernels<Real>(kWidestPack);
  SystemContacts<Real> ofFirst;
  Threads threads(2);
  for (const SweepKernel<Real>& kernel : kernels) {
    for (const bool sideBySide : {false, true}) {
      Pile<Real> other(kernel.points);
      Pile<Real> first(kernels[0].points);
      ExpectTheSame<Real>(first, other, 0);
      const auto motions = [&] { return sideBySide ? other.MotionsOfPoints() : other.Motions(); };
      SystemContacts<Real> contacts;
      contacts.Build(other.contactPairs, other.pointers, kernel.bodyContacts);
      ofFirst.Build(first.contactPairs, first.pointers, kernels[0].bodyContacts);
      for (int substep = 0; substep < 4; ++substep) {
        contacts.ComputeForces(motions(), &threads);
        ofFirst.ComputeForces(first.Motions(), nullptr);
        EXPECT_EQ(other.AddUp(contacts), first.AddUp(ofFirst));
        other.Move(substep);
        first.Move(substep);
        contacts.Update(motions(), static_cast<Real>(kTick / 4), &threads);
        ofFirst.Update(first.Motions(), static_cast<Real>(kTick / 4), nullptr);
        ExpectTheSame<Real>(other, first, 0);
      }
    }
  }
}

// A tick that is stepped again restores its lists; the forces must follow.
TYPED_TEST(SystemContactsTest, ReadsListsThatOthersHaveChanged) {
  using Real = TypeParam;
  const SweepKernel<Real>& kernel = FindSweepKernels<Real>(kWidestPack).back();
  Pile<Real> pile(kernel.points);
  const auto lists = pile.lists;
  SystemContacts<Real> contacts;
  contacts.Build(pile.contactPairs, pile.pointers, kernel.bodyContacts);
  contacts.ComputeForces(pile.Motions(), nullptr);
  const auto before = pile.AddUp(contacts);
  contacts.Update(pile.Motions(), static_cast<Real>(kTick / 4), nullptr);
  for (std::size_t pair = 0; pair < lists.size(); ++pair) pile.lists[pair] = lists[pair];
  contacts.ReadLists();
  contacts.ComputeForces(pile.Motions(), nullptr);
  EXPECT_EQ(pile.AddUp(contacts), before);
}

TYPED_TEST(SystemContactsTest, FindsPointsAsALoopOverAllDoes) {
  using Real = TypeParam;
  const Blueprint ball = MakeBall(MakeMeasuredBall());
  const State<Real> state = MakeState<Real>(ball, Vector3d::Zero(), Vector3d::Zero());
  const Skin<Real> skin{ball.Read<Real>().faces, &ball.topology, state.positions};
  SkinPoints<Real> points;
  points.Read(skin, state.velocities);
  EXPECT_NEAR(points.Radius(), Real(1), Real(0.02));
  NearRegion<Real> region{
      .low = {-2, -2, Real(0.1)}, .high = {Real(0.9), 2, 2}, .centre = {Real(0.5), 0, 0}, .squaredRadius = Real(1.2)};
  for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
    std::vector<std::uint16_t> found(points.Lanes().count);
    found.resize(kernel.points.findWithin(points.Lanes(), region, found.data()));
    std::vector<std::uint16_t> expected;
    const Vector3<Real> centre(region.centre[0], region.centre[1], region.centre[2]);
    for (std::uint16_t i = 0; i < state.positions.size(); ++i) {
      const Vector3<Real>& x = state.positions[i];
      if (x[0] <= region.high[0] && x[2] >= region.low[2] && (x - centre).squaredNorm() <= region.squaredRadius) {
        expected.push_back(i);
      }
    }
    ASSERT_GT(expected.size(), 20U);
    EXPECT_EQ(found, expected);
    for (const Vector3<Real>& p : Shake<Real>(50, 1.5, 3)) {
      const NearestPoint<Real> nearest = kernel.points.findNearest(points.Lanes(), p.data());
      for (const Vector3<Real>& x : state.positions) {
        EXPECT_GE((x - p).squaredNorm(), nearest.square * (1 - 8 * std::numeric_limits<Real>::epsilon()));
      }
      EXPECT_NEAR((state.positions[nearest.index] - p).squaredNorm(), nearest.square,
                  8 * std::numeric_limits<Real>::epsilon() * nearest.square);
    }
  }
}

}  // namespace
}  // namespace wobble::physics
