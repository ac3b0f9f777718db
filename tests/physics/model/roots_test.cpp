#include "server/physics/model/roots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace wobble::physics {
namespace {

TEST(Roots, CubesHaveTheirRoots) {
  EXPECT_EQ(FindCubeRoot(0), 0);
  for (const double root : {1.0, 2.0, 3.0, 0.5, 0.25, 1.5, 1000.0, 0x1p-300, 0x1p300}) {
    EXPECT_EQ(FindCubeRoot(root * root * root), root);
  }
}

// The bound is half a unit in the last place of the root, and the rounding of the check.
TEST(Roots, AreRightToRounding) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponents(-60, 60);
  for (int i = 0; i < 10000; ++i) {
    const double x = std::exp2(exponents(random));
    const double root = FindCubeRoot(x);
    const long double error = static_cast<long double>(root) - std::cbrt(static_cast<long double>(x));
    const double unit = std::nextafter(root, std::numeric_limits<double>::infinity()) - root;
    EXPECT_LE(std::fabs(static_cast<double>(error)), 0.51 * unit) << x;
  }
}

TEST(Roots, HypotenusesOfWholeNumbers) {
  EXPECT_EQ(FindHypotenuse(3, 4), 5);
  EXPECT_EQ(FindHypotenuse(-5, 12), 13);
  EXPECT_EQ(FindHypotenuse(0, 2), 2);
}

}  // namespace
}  // namespace wobble::physics
