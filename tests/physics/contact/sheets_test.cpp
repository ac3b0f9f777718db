// Sheets hold what is shot at them faster than they can stop it within their own thickness: vertices end up behind the
// sheet, and contacts that remember where they came from pull them back.
#include <gtest/gtest.h>

#include "server/physics/contact/body_contact_view.h"
#include "tests/bench/stability/stress_shots.h"

namespace wobble::physics {
namespace {

// Of the shots at sheets of the laboratory's stress part some that passed while contacts were lost behind ridges and
// tips, or were dropped where boxes came apart: pairs, a graph, balls and lattices at 63 to 96 m/s. And the pairs and
// graphs that a fold of the sheet held behind it by their middles, at 20 to 85 m/s. And a lattice and a solid whose
// contacts went over to layers of the crumpled sheet that looked the other way, at 67 and 89 m/s.
TEST(Sheets, HoldWhatIsShotAtThem) {
  for (const std::size_t number : {124, 159, 234, 299, 374, 454, 689, 759, 39, 269, 324, 554, 639, 979, 829, 914}) {
    const bench::StressShot shot = bench::PlayStressShot(1, number);
    ASSERT_EQ(shot.target, bench::StressTarget::kSheet) << number;
    EXPECT_FALSE(shot.through || shot.hangs)
        << "shot " << number << ", " << bench::NameStressBody(shot.body) << " at " << shot.speed;
    EXPECT_EQ(shot.outcome.reset + shot.outcome.nonFinite, 0U) << number;
  }
}

// A roof of two faces over the y axis: its ridge is at z = 0, its eaves at z = -1.
struct Roof {
  std::vector<Vector3d> x{{0, -1, 0}, {0, 1, 0}, {1, 0, -1}, {-1, 0, -1}};
  std::vector<Face> faces{{0, 2, 1}, {0, 1, 3}};
  Topology topology = MakeTopology(faces, x.size());
};

// From below, the vertex has come out above the ridge, where it is straight below no face.
TEST(Sheets, PullBackToTheRidgeSteadily) {
  const Roof roof;
  const Skin<double> skin{
      .faces = roof.faces, .topology = &roof.topology, .x = std::span<const Vector3d>(roof.x), .side = -1};
  const BodyContact<double> contact{
      .phase = ContactPhase::kTouching, .side = SkinSide::kBack, .maxDepth = 0.6, .depth = 0.4};
  const auto see = [&](const Vector3d& p) { return FindSeen(skin, contact, FindFacePoint(skin, 0, p), p); };
  const FacePoint<double> above = see({0, 0, 0.4});
  EXPECT_NEAR(above.distance, -0.4, 1e-12);
  EXPECT_NEAR((above.normal - Vector3d(0, 0, -1)).norm(), 0, 1e-12);
  EXPECT_NEAR(see({0.4 - 1e-9, 0, 0.4}).distance, see({0.4 + 1e-9, 0, 0.4}).distance, 1e-8);
}

// Beside a face its plane says little of the side. Within a substep a vertex cannot have come so far.
TEST(Sheets, KeepTheSideThatNoMotionCanHaveChanged) {
  const Roof roof;
  const Skin<double> skin{.faces = roof.faces, .topology = &roof.topology, .x = std::span<const Vector3d>(roof.x)};
  const Vector3d p(-0.4, 0, -0.2);  // behind the plane of face 0, beside it
  BodyContact<double> contact{.phase = ContactPhase::kArmed, .maxDepth = 0.05, .depth = -0.3};
  const FacePoint<double> plane = FindFacePoint(skin, 0, p);
  ASSERT_LT(plane.distance, 0);
  ASSERT_LT(plane.weights.minCoeff(), 0);
  EXPECT_GT(FindSeen(skin, contact, plane, p).distance, 0) << "it was in front, and far off";
  contact.depth = 0.3;
  EXPECT_LT(FindSeen(skin, contact, plane, p).distance, 0);
}

}  // namespace
}  // namespace wobble::physics
