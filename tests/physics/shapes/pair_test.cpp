// Pairs: the one body whose motion is known in closed form.
#include "server/physics/shapes/pair.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/physics/methods/runge_kutta.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

// A pair that is stretched by 5 cm and let go: x = x₀ e^{−ζωt} (cos ω't + ζω/ω' sin ω't), ω² = k/μ.
void ExpectRings(PairDefinition definition, double reducedMass) {
  const Blueprint pair = MakePair(definition);
  const double omega = std::sqrt(definition.material.stiffness / reducedMass);
  EXPECT_NEAR(pair.angularFrequency / 1.05, omega, 1e-6 * omega);
  const double decay = pair.full.springs[0].damping / (2 * reducedMass);
  const double ringing = std::sqrt(omega * omega - decay * decay);
  std::vector<Vector3d> x = pair.rest;
  std::vector<Vector3d> v(2, Vector3d::Zero());
  const Vector3d along = (x[1] - x[0]).normalized();
  x[1] += 0.05 * along;
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(pair.full, Load<double>{}, {}, {}, at, speed, a);
  };
  constexpr double h = 1.0 / 1000;
  for (int step = 1; step <= 2000; ++step) {
    StepRungeKutta<double>(kClassicRungeKutta, h, accelerate, std::span(x), std::span(v), buffers);
    const double t = h * step;
    const double exact =
        0.05 * std::exp(-decay * t) * (std::cos(ringing * t) + decay / ringing * std::sin(ringing * t));
    ASSERT_NEAR((x[1] - x[0]).norm() - definition.length, exact, 1e-8) << t;
  }
}

TEST(Pair, RingsAsTheFormulaSays) {
  PairDefinition definition;
  definition.material.dampingRatio = 0.1;
  definition.direction = {1, -2, 3};
  ExpectRings(definition, 0.5);
  definition.firstIsFixed = true;
  ExpectRings(definition, 1);
}

TEST(Pair, DampingRatioIsThatOfTheTwoMasses) {
  PairDefinition definition;
  definition.material.dampingRatio = 1;
  const Blueprint pair = MakePair(definition);
  const double omega = std::sqrt(definition.material.stiffness / 0.5);
  EXPECT_NEAR(pair.full.springs[0].damping / (2 * 0.5), omega, 1e-12) << "critical";
}

TEST(Pair, ValidateNamesFieldValueAndRange) {
  PairDefinition definition;
  EXPECT_TRUE(ValidatePair(definition).empty());
  definition.length = -1;
  definition.direction = Vector3d::Zero();
  definition.material.mass = 0;
  const auto errors = ValidatePair(definition);
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0].field, "length");
  EXPECT_EQ(errors[1].field, "direction");
  EXPECT_EQ(errors[2].field, "mass");
  PairDefinition rigid;
  rigid.material.stiffness = 1e8;
  ASSERT_EQ(ValidatePair(rigid).size(), 1U);
  EXPECT_EQ(ValidatePair(rigid)[0].field, "stiffness");
}

}  // namespace
}  // namespace wobble::physics
