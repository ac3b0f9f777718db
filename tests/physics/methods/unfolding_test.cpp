// The term that turns folded cells right side out: energy, forces, both momenta, its bound on the step, and that it
// leaves alone what is not folded.
#include "server/physics/methods/unfolding.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "tests/bench/random.h"
#include "tests/physics/bodies.h"
#include "tests/support/broken_states.h"

namespace wobble::physics {
namespace {

using Shape = std::vector<Vector3d>;

Blueprint MakeBlock(const std::array<int, 3>& cells) {
  LatticeDefinition block;
  block.cells = cells;
  block.poissonRatio = FindPoissonRatio(cells);
  return MakeLattice(block);
}

std::vector<Blueprint> MakeBlocks() { return {MakeBlock({2, 1, 2}), MakeBlock({3, 3, 3}), MakeBlock({3, 0, 2})}; }

// In the plane of a planar body.
void AddDisorder(const Blueprint& blueprint, double amplitude, bench::Random& random, Shape& x) {
  for (Vector3d& at : x) {
    for (int axis = 0; axis < 3; ++axis) {
      const double by = amplitude * random.Draw(-1, 1);
      at[axis] += blueprint.full.planar && axis == 1 ? 0 : by;
    }
  }
}

// Broken in every way, each a little uneven.
std::vector<Shape> MakeFoldedStates(const Blueprint& blueprint) {
  std::vector<Shape> states;
  bench::Random random(7);
  for (const Broken how : kAllBroken) {
    states.push_back(Break(how, blueprint, random));
    AddDisorder(blueprint, 0.02, random, states.back());
  }
  states.push_back(blueprint.rest);  // almost a point
  for (Vector3d& at : states.back()) at *= 0.1;
  AddDisorder(blueprint, 0.01, random, states.back());
  return states;
}

Shape FindFoldForces(const Blueprint& blueprint, const Shape& x, const Shape& v) {
  Shape forces(x.size(), Vector3d::Zero());
  AddUnfolding<double>(blueprint.full.cells, 1, x, v, forces);
  return forces;
}
Shape FindFoldForces(const Blueprint& blueprint, const Shape& x) {
  return FindFoldForces(blueprint, x, Shape(x.size(), Vector3d::Zero()));
}

double FindLargest(const Shape& vectors) {
  double largest = 0;
  for (const Vector3d& each : vectors) largest = std::max(largest, each.norm());
  return largest;
}

// The least singular value of any corner, negative where it is inside out, by Eigen.
double FindThinnest(const Blueprint& blueprint, const Shape& x) {
  const Cells<double>& cells = blueprint.full.cells;
  double thinnest = 10;
  for (const std::uint16_t first : cells.first) {
    for (unsigned bits = 0; bits < 8; ++bits) {
      if (blueprint.full.planar && (bits & 2U) != 0) continue;
      std::size_t own = first;
      for (std::size_t axis = 0; axis < 3; ++axis) own += (bits >> axis & 1U) * cells.strides[axis];
      Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (cells.strides[axis] == 0) continue;
        const std::size_t from = (bits >> axis & 1U) != 0 ? own - cells.strides[axis] : own;
        f.col(static_cast<int>(axis)) = kFoldWeights[axis] / cells.edge * (x[from + cells.strides[axis]] - x[from]);
      }
      const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f);
      thinnest = std::min(thinnest, svd.singularValues()[2] * (f.determinant() < 0 ? -1 : 1));
    }
  }
  return thinnest;
}

TEST(Unfolding, ForcesAreTheGradientOfTheEnergy) {
  constexpr double kStep = 1e-7;
  for (const Blueprint& blueprint : MakeBlocks()) {
    for (Shape x : MakeFoldedStates(blueprint)) {
      const Shape forces = FindFoldForces(blueprint, x);
      const double largest = FindLargest(forces);
      ASSERT_GT(largest, 1);
      for (std::size_t i = 0; i < x.size(); ++i) {
        for (const int axis : {0, 2}) {
          const double at = x[i][axis];
          x[i][axis] = at + kStep;
          const double above = ComputeFoldEnergy(blueprint.full.cells, x);
          x[i][axis] = at - kStep;
          const double below = ComputeFoldEnergy(blueprint.full.cells, x);
          x[i][axis] = at;
          ASSERT_NEAR(forces[i][axis], -(above - below) / (2 * kStep), 1e-5 * largest) << "vertex " << i;
        }
      }
    }
  }
}

TEST(Unfolding, KeepsBothMomentaAndTakesEnergy) {
  bench::Random random(3);
  for (const Blueprint& blueprint : MakeBlocks()) {
    for (const Shape& x : MakeFoldedStates(blueprint)) {
      Shape v(x.size(), Vector3d::Zero());
      AddDisorder(blueprint, 5, random, v);
      const Shape forces = FindFoldForces(blueprint, x, v);
      const Shape elastic = FindFoldForces(blueprint, x);
      Vector3d sum = Vector3d::Zero();
      Vector3d torque = Vector3d::Zero();
      double power = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        sum += forces[i];
        torque += x[i].cross(forces[i]);
        power += v[i].dot(forces[i] - elastic[i]);
      }
      const double largest = FindLargest(forces);
      EXPECT_LT(sum.norm(), 1e-11 * largest);
      EXPECT_LT(torque.norm(), 1e-11 * largest);
      EXPECT_LT(power, 0);
      // A turn and a push are no deformation.
      const Vector3d turn(1, blueprint.full.planar ? 2 : -2, 3);
      for (std::size_t i = 0; i < x.size(); ++i) {
        v[i] = blueprint.full.planar ? Vector3d(2 * x[i].z() + 1, 0, -2 * x[i].x()) : Vector3d(turn.cross(x[i]) + turn);
      }
      const Shape rigid = FindFoldForces(blueprint, x, v);
      for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((rigid[i] - elastic[i]).norm(), 1e-9 * largest);
    }
  }
}

TEST(Unfolding, ActsOnNothingThickerThanItsLimit) {
  for (const Blueprint& blueprint : MakeBlocks()) {
    const double limit = kFoldStretch / kFoldWeights[2];
    for (const double thickness : {limit + 1e-6, limit - 1e-6}) {
      Shape x = blueprint.rest;
      for (Vector3d& at : x) at = {2 * at.x(), at.y(), thickness * at.z()};
      const bool isThin = thickness < limit;
      EXPECT_EQ(HasFolds<double>(blueprint.full.cells, x), isThin);
      EXPECT_EQ(ComputeFoldEnergy(blueprint.full.cells, x) > 0, isThin);
      EXPECT_EQ(FindLargest(FindFoldForces(blueprint, x)) > 0, isThin);
    }
  }
}

// What HasFolds does not look at is never folded, and what it finds is.
TEST(Unfolding, FindsFoldsAsSingularValuesDo) {
  bench::Random random(11);
  for (const Blueprint& blueprint : MakeBlocks()) {
    int folded = 0;
    for (int trial = 0; trial < 600; ++trial) {
      Shape x = blueprint.rest;
      const Vector3d stretch = random.DrawWithin({0.3, 1, 0.3}, {1.5, 1, 1.5});
      for (Vector3d& at : x) at = at.cwiseProduct(stretch);
      AddDisorder(blueprint, random.Draw(0, 0.1), random, x);
      const bool isFolded = FindThinnest(blueprint, x) < kFoldStretch;
      EXPECT_EQ(HasFolds<double>(blueprint.full.cells, x), isFolded) << trial;
      folded += isFolded ? 1 : 0;
    }
    EXPECT_GT(folded, 60);
    EXPECT_LT(folded, 540);
  }
}

// The largest curvature of the energy over the masses, by a power iteration that is shifted so that crests of the
// energy, which are negative, do not win.
TEST(Unfolding, NeverSwingsFasterThanItsBound) {
  constexpr double kStep = 1e-7;
  for (const Blueprint& blueprint : MakeBlocks()) {
    const Cells<double>& cells = blueprint.full.cells;
    const double shift = cells.squareFrequency;
    for (const Shape& x : MakeFoldedStates(blueprint)) {
      Shape mode = Deform(Shape(x.size(), Vector3d::Zero()), 1);
      double curvature = 0;
      for (int i = 0; i < 60; ++i) {
        double square = 0;
        for (const Vector3d& each : mode) square += each.squaredNorm();
        for (Vector3d& each : mode) each /= std::sqrt(square);
        Shape ahead = x;
        Shape behind = x;
        for (std::size_t j = 0; j < x.size(); ++j) {
          if (blueprint.full.planar) mode[j].y() = 0;
          ahead[j] += kStep * mode[j];
          behind[j] -= kStep * mode[j];
        }
        const Shape above = FindFoldForces(blueprint, ahead);
        const Shape below = FindFoldForces(blueprint, behind);
        curvature = 0;
        for (std::size_t j = 0; j < x.size(); ++j) {
          const Vector3d applied = (below[j] - above[j]) / (2 * kStep * blueprint.full.masses[j]);
          curvature += mode[j].dot(applied);
          mode[j] = applied + shift * mode[j];
        }
      }
      EXPECT_LT(curvature, 1.001 * cells.squareFrequency);
    }
  }
}

}  // namespace
}  // namespace wobble::physics
