// Sheets hold what is shot at them faster than they can stop it within their own thickness: vertices end up behind the
// sheet, and contacts that remember where they came from pull them back.
#include <gtest/gtest.h>

#include "server/physics/shapes/material.h"
#include "server/physics/skins/body_contact_update.h"
#include "server/physics/skins/body_contact_view.h"
#include "tests/bench/stress/shots.h"

namespace wobble::physics {
namespace {

struct SheetShot {
  std::uint64_t seed;
  std::size_t number;
};

// Of the shots at sheets of the laboratory's stress part some that passed while contacts were lost behind ridges and
// tips, or were dropped where boxes came apart: pairs, a graph, balls and lattices at 63 to 96 m/s. And the pairs and
// graphs that a fold of the sheet held behind it by their middles, at 20 to 85 m/s. And a lattice and a solid whose
// contacts went over to layers of the crumpled sheet that looked the other way, at 67 and 89 m/s. And a lattice and two
// balls that planes of faces beside them took to be on the other side of the sheet, at 83 to 95 m/s.
TEST(Sheets, HoldWhatIsShotAtThem) {
  for (const auto& [seed, number] : {SheetShot{1, 124},
                                     {1, 159},
                                     {1, 234},
                                     {1, 299},
                                     {1, 689},
                                     {1, 759},
                                     {1, 39},
                                     {1, 269},
                                     {1, 324},
                                     {1, 979},
                                     {1, 829},
                                     {1, 914},
                                     {3, 639},
                                     {4, 449},
                                     {4, 664}}) {
    const bench::StressShot shot = bench::PlayStressShot(seed, number);
    ASSERT_EQ(shot.target, bench::StressTarget::kSheet) << number;
    EXPECT_FALSE(shot.through || shot.hangs)
        << "seed " << seed << " shot " << number << ", " << bench::NameStressBody(shot.body) << " at " << shot.speed;
    EXPECT_EQ(shot.outcome.reset + shot.outcome.nonFinite, 0U) << seed << " " << number;
  }
}

// Two faces over the y axis, which rise by `slope` from z = 0: a roof with its eaves at z = -1, or a valley.
struct Roof {
  std::vector<Vector3d> x;
  std::vector<Face> faces{{0, 2, 1}, {0, 1, 3}};
  Topology topology = MakeTopology(faces, 4);

  explicit Roof(double slope = -1) : x{{0, -1, 0}, {0, 1, 0}, {1, 0, slope}, {-1, 0, slope}} {}
};

// Moves the contact's vertex to p, at rest, beside a roof whose skin has a gap; returns whether a force acts.
bool UpdateAt(const Roof& roof, double gap, const Vector3d& p, BodyContact<double>& contact) {
  const std::vector<Vector3d> still(4, Vector3d::Zero());
  const std::vector<double> shares{1};
  const std::vector<Vector3d> x{p};
  Material material;
  material.stiffness = 1000;
  const Meeting<double> meeting{
      .x = x,
      .v = std::span<const Vector3d>(still).first(1),
      .shares = shares,
      .skin = {.faces = roof.faces, .topology = &roof.topology, .x = std::span<const Vector3d>(roof.x), .offset = gap},
      .skinV = std::span<const Vector3d>(still)};
  const ContactParameters<double> parameters = MakeContactParameters(material, 1, 0.5);
  UpdateBodyContacts<double>(parameters, meeting, 1e-3, {&contact, 1});
  ContactForce<double> force;
  ComputeBodyContacts<double>(parameters, meeting, {&contact, 1}, {&force, 1});
  return force.acts;
}

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

// Past a border it is the distance from the skin that counts, not that from the plane of the last face.
TEST(Sheets, PushPastABorderByTheDistanceFromIt) {
  const Roof roof;
  const Skin<double> skin{
      .faces = roof.faces, .topology = &roof.topology, .x = std::span<const Vector3d>(roof.x), .offset = 0.1};
  const BodyContact<double> contact{.phase = ContactPhase::kTouching, .maxDepth = 0.2, .depth = 0.05};
  const Vector3d eaves(1, 0, -1);
  const Vector3d out = Vector3d(1, 0, -1).normalized();  // down the slope of the first face
  const Vector3d up = Vector3d(1, 0, 1).normalized();
  for (const double height : {1e-9, 0.02}) {
    const Vector3d p = eaves + 0.05 * out + height * up;
    const FacePoint<double> at = FindSeen(skin, contact, FindFacePoint(skin, 0, p), p);
    EXPECT_TRUE(at.rounded) << height;
    EXPECT_NEAR(at.distance, std::hypot(0.05, height) - 0.1, 1e-8) << height;
  }
}

// A vertex that a gap keeps off a valley.
struct Valley {
  Roof sides;
  Vector3d p = Vector3d::Zero();
  BodyContact<double> contact{.phase = ContactPhase::kTouching, .maxDepth = 0.011, .depth = 0.001};
  static constexpr double kOffset = 0.03;

  [[nodiscard]] FacePoint<double> See(std::uint16_t face) const {
    return FindFacePoint<double>(
        {.faces = sides.faces, .topology = &sides.topology, .x = std::span<const Vector3d>(sides.x)}, face, p);
  }
  // Puts the vertex's foot `beyond` m past the edge, `height` m above the plane of face 0.
  void MoveTo(double beyond, double height) {
    p = height * See(0).normal - beyond * sides.x[2].normalized();
    UpdateAt(sides, kOffset, p, contact);
  }
};

// Over the edge the other side's gap is up to all of Skin::offset deep at once: of a stiff pair in an open mesh it made
// energy enough to throw both. Below the other side's plane the vertex is pushed all the same.
TEST(Sheets, PushOutOfAValleyWhatHasComeIntoIt) {
  for (const double slope : {0.6, 0.8}) {
    Valley valley{.sides = Roof(slope)};
    valley.MoveTo(-0.001, 0.029);
    ASSERT_EQ(valley.contact.face, 0) << slope;
    ASSERT_NEAR(valley.contact.depth, 0.001, 1e-9);
    valley.MoveTo(1e-6, 0.029);
    EXPECT_EQ(valley.contact.face, 1) << slope;
    EXPECT_GT(valley.contact.leap, 0.008) << slope;
    EXPECT_LT(valley.contact.depth, 0.0011) << slope;
    for (int i = 1; i <= 50; ++i) valley.MoveTo(0.001 * i, 0.029);
    const double below = -valley.See(1).distance;
    ASSERT_GT(below, 0.001);
    EXPECT_GE(valley.contact.depth, below - 1e-9) << slope;
  }
}

// A vertex whose walk has ended at a layer of the skin that is turned over: it is behind it by `below` m without having
// passed it.
struct TurnedLayer {
  Roof roof;
  BodyContact<double> contact{.phase = ContactPhase::kTouching, .maxDepth = 0.013, .depth = 0.003};
  bool acts = false;
  static constexpr double kOffset = 0.007;

  void MoveTo(double below) {
    acts = UpdateAt(roof, kOffset, Vector3d(0.5, 0, -0.5) - below * Vector3d(1, 0, 1).normalized(), contact);
  }
};

// The spring between would be of up to two offsets, and nobody has pressed it: neither as the vertex comes nearer, nor
// when it comes out in front. What it presses there itself counts.
TEST(Sheets, DoNotPushWhatStandsBehindATurnedLayer) {
  TurnedLayer layer;
  for (const double below : {0.05, 0.02, 0.012, 0.006, 0.002}) {
    layer.MoveTo(below);
    EXPECT_EQ(layer.contact.phase, ContactPhase::kAside) << below;
    EXPECT_FALSE(layer.acts) << below;
  }
  layer.MoveTo(-0.002);
  EXPECT_EQ(layer.contact.phase, ContactPhase::kArmed);
  EXPECT_FALSE(layer.acts);
  layer.MoveTo(-0.004);
  layer.MoveTo(-0.003);
  EXPECT_EQ(layer.contact.phase, ContactPhase::kTouching);
  EXPECT_NEAR(layer.contact.depth, 0.001, 1e-9);
}

// A tent with its tip at the origin, steeper on one side. Seen from below, p, above the tip, is behind; of the faces,
// all as near, the steep one's plane has it in front.
TEST(Sheets, TellTheSideOfATipByAllFacesRoundIt) {
  const std::vector<Vector3d> x{{0, 0, 0}, {1, 1, -3}, {-1, 1, -2}, {-1, -1, -2}, {1, -1, -3}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  const Topology topology = MakeTopology(faces, x.size());
  const Vector3d p(-0.1, 0, 0.1);
  for (const double side : {1.0, -1.0}) {
    const Skin<double> skin{.faces = faces, .topology = &topology, .x = std::span<const Vector3d>(x), .side = side};
    const BodyContact<double> contact{
        .phase = ContactPhase::kArmed, .maxDepth = 1, .depth = -0.01 * side};  // may have come from anywhere near
    for (std::uint16_t face = 0; face < faces.size(); ++face) {
      const FacePoint<double> plane = FindFacePoint(skin, face, p);
      const double distance = FindSeen(skin, contact, plane, p).distance;
      EXPECT_EQ(distance > 0, side > 0) << "from face " << face;
    }
    EXPECT_LT(FindFacePoint(skin, 1, p).distance * FindFacePoint(skin, 3, p).distance, 0) << "the planes contradict";
  }
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
