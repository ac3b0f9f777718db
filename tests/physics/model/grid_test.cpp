// The sweep of grids against the plain reference, and the same bits at every width.
#include <gtest/gtest.h>

#include "server/physics/kernels/kernels.h"
#include "server/physics/methods/runge_kutta.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/tear.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

// A moving body with all arrays that a sweep reads.
template <class Real>
struct Problem {
  explicit Problem(const Blueprint& made) : blueprint(made) {
    const std::vector<Vector3d> bent = Deform(blueprint.rest, 0.01);
    for (std::size_t i = 0; i < bent.size(); ++i) {
      const auto phase = static_cast<double>(i);
      const double across = blueprint.full.planar ? 0 : 1;
      x.push_back(Vector3d(bent[i].x(), across * bent[i].y(), bent[i].z()).template cast<Real>());
      v.push_back(Vector3d(0.5 * std::sin(phase), across * std::cos(1.7 * phase), 0.3).template cast<Real>());
    }
    for (const std::uint16_t vertex : blueprint.full.fixed) v[vertex].setZero();
    load.acceleration = Vector3<Real>(Real(0.5), 0, Real(-9.81));
    load.stiffnessFactor = Real(1.2);
    load.wind = Vector3<Real>(Real(1), Real(4), Real(-0.5));
    load.torn = torn;
  }

  // A push on every seventh vertex.
  void Push() {
    for (std::size_t i = 0; i < x.size(); i += 7) {
      pushes.push_back({static_cast<std::uint16_t>(i), Vector3<Real>(Real(0.2), Real(-0.1), Real(0.1))});
    }
    load.pushes = pushes;
  }
  void Tear(std::size_t every) {
    torn.assign(blueprint.full.springs.size(), 0);
    for (std::size_t i = 0; i < torn.size(); i += every) torn[i] = 1;
    load.torn = torn;
  }

  void StepPlainly(int steps) {
    StageBuffers<Real, 4> buffers;
    for (int i = 0; i < steps; ++i) {
      StepRungeKutta<Real>(
          kClassicRungeKutta, step,
          [this](auto atX, auto atV, auto a) {
            ComputeAccelerations<Real>(blueprint.Read<Real>(), load, {}, {}, atX, atV, a);
          },
          x, v, buffers);
      velocityErrors = 0;
      for (std::size_t k = 0; k < v.size(); ++k) velocityErrors += (buffers.velocities[3][k] - v[k]).squaredNorm();
    }
  }

  void StepInRows(int steps, const SweepKernel<Real>& kernel);

  const Blueprint& blueprint;
  Real step = static_cast<Real>(0.3 / blueprint.angularFrequency);
  std::vector<Vector3<Real>> x;
  std::vector<Vector3<Real>> v;
  std::vector<VertexForce<Real>> pushes;
  std::vector<std::uint8_t> torn;
  Load<Real> load;
  Real velocityErrors = 0;
  Real accelerationErrors = 0;
};

template <class Real>
void Problem<Real>::StepInRows(int steps, const SweepKernel<Real>& kernel) {
  const GridPlan<Real>& plan = blueprint.ReadGridPlan<Real>();
  ASSERT_GT(plan.rows, 0U);
  const std::size_t width = plan.width;
  const auto makeArray = [](std::size_t numbers) {
    return std::vector<GridLine<Real>>(numbers / GridLine<Real>::kNumbers + 1);
  };
  const auto numbersOf = [](std::vector<GridLine<Real>>& lines) { return reinterpret_cast<Real*>(lines.data()); };
  std::vector<std::vector<GridLine<Real>>> arrays(4, makeArray(6 * width * plan.CountPlaces()));
  std::vector<GridLine<Real>> outer = makeArray(3 * width * plan.CountPlaces());
  std::vector<GridLine<Real>> pending = makeArray(plan.pendingSize);
  std::vector<Real> acceleration(3 * width);
  std::vector<Real> wind(3 * width);
  std::vector<std::uint8_t> hasOuter(plan.rows, 0);
  GridRows<Real> whole;
  if (!torn.empty()) RemoveTorn(plan, blueprint.Read<Real>(), torn, whole);
  const GridTables<Real> tables = plan.Tables(torn.empty() ? plan.coefficients : whole);
  for (int k = 0; k < 3; ++k) {
    acceleration[k * width] = load.acceleration[k];
    wind[k * width] = load.wind[k];
    for (std::size_t i = 0; i < x.size(); ++i) {
      Real* at = numbersOf(arrays[0]) + 6 * plan.RowOf(i) * width + plan.ColumnOf(i);
      at[k * width] = x[i][k];
      at[(k + 3) * width] = v[i][k];
    }
    for (const VertexForce<Real>& push : pushes) {
      numbersOf(outer)[(3 * plan.RowOf(push.vertex) + k) * width + plan.ColumnOf(push.vertex)] = push.force[k];
      hasOuter[plan.RowOf(push.vertex)] = 1;
    }
  }
  SweepLanes<Real> lanes;
  lanes.state = numbersOf(arrays[0]);
  lanes.stage = numbersOf(arrays[1]);
  lanes.nextStage = numbersOf(arrays[2]);
  lanes.increments = numbersOf(arrays[3]);
  lanes.pending = numbersOf(pending);
  lanes.outer = pushes.empty() ? nullptr : numbersOf(outer);
  lanes.hasOuter = hasOuter.data();
  lanes.acceleration = acceleration.data();
  lanes.wind = wind.data();
  lanes.stiffnessFactors = &load.stiffnessFactor;
  lanes.velocityErrors = &velocityErrors;
  lanes.accelerationErrors = &accelerationErrors;
  for (int i = 0; i < steps; ++i) {
    for (const auto stage : kernel.gridStages) stage(tables, lanes, step);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real* at = lanes.state + 6 * plan.RowOf(i) * width + plan.ColumnOf(i);
    x[i] = Vector3<Real>(at[0], at[width], at[2 * width]);
    v[i] = Vector3<Real>(at[3 * width], at[4 * width], at[5 * width]);
  }
}

Blueprint MakeSheet(std::array<int, 2> points, Pinned pinned, double drag, double bend = 0.1,
                    double bendStiffness = 0) {
  ClothDefinition definition;
  definition.name = "cloth of " + std::to_string(points[0]) + " x " + std::to_string(points[1]);
  definition.points = points;
  definition.pinned = pinned;
  definition.bend = bend;
  definition.bendStiffness = bendStiffness;
  definition.material.drag = drag;
  definition.tearStretch = 1.5;
  return MakeCloth(definition);
}

Blueprint MakeSolid(std::array<int, 3> cells, Side fixed = Side::kNone) {
  LatticeDefinition definition;
  definition.name =
      "lattice of " + std::to_string(cells[0]) + " x " + std::to_string(cells[1]) + " x " + std::to_string(cells[2]);
  definition.cells = cells;
  definition.poissonRatio = FindPoissonRatio(cells);
  definition.fixed = fixed;
  return MakeLattice(definition);
}

// Rows shorter than a vector, as long as one, and longer; sheets, solids and planar bodies; with and without fixed
// vertices.
std::vector<Blueprint> MakeGrids() {
  std::vector<Blueprint> grids;
  grids.push_back(MakeSheet({2, 2}, Pinned::kNone, 0.6));
  grids.push_back(MakeSheet({5, 9}, Pinned::kTopCorners, 0.6));
  grids.push_back(MakeSheet({16, 3}, Pinned::kEdge, 0));
  grids.push_back(MakeSheet({37, 20}, Pinned::kCorners, 0.6));
  grids.push_back(MakeSheet({33, 40}, Pinned::kNone, 0, 0));
  grids.push_back(MakeSheet({2, 2}, Pinned::kNone, 0, 0, 0.2));
  grids.push_back(MakeSheet({3, 7}, Pinned::kNone, 0.6, 0, 0.2));
  grids.push_back(MakeSheet({21, 2}, Pinned::kTopCorners, 0, 0.1, 0.2));
  grids.push_back(MakeSheet({37, 20}, Pinned::kClamp, 0.6, 0, 0.2));
  grids.push_back(MakeSheet({70, 60}, Pinned::kClamp, 0, 0, 0.2));  // too large for one row
  grids.push_back(MakeSolid({3, 3, 3}));
  grids.push_back(MakeSolid({1, 1, 1}));
  grids.push_back(MakeSolid({1, 2, 17}, Side::kLowZ));
  grids.push_back(MakeSolid({20, 4, 3}, Side::kLowX));
  grids.push_back(MakeSolid({12, 0, 5}, Side::kLowX));
  return grids;
}

template <class Real>
double FindLargestDifference(const std::vector<Vector3<Real>>& a, const std::vector<Vector3<Real>>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, double{(a[i] - b[i]).norm()});
  return largest;
}

template <class Real>
class GridTest : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GridTest, Precisions);

TYPED_TEST(GridTest, DoesWhatThePlainReferenceDoes) {
  using Real = TypeParam;
  const double rounding = sizeof(Real) == 4 ? 4e-6 : 1e-14;
  for (const Blueprint& grid : MakeGrids()) {
    for (const bool pushed : {false, true}) {
      for (const std::size_t tornEvery : {0, 5}) {
        Problem<Real> plain(grid);
        if (pushed) plain.Push();
        if (tornEvery > 0) plain.Tear(tornEvery);
        plain.StepPlainly(4);
        for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
          Problem<Real> inRows(grid);
          if (pushed) inRows.Push();
          if (tornEvery > 0) inRows.Tear(tornEvery);
          inRows.StepInRows(4, kernel);
          EXPECT_LT(FindLargestDifference(inRows.x, plain.x), rounding * std::max(1.0, grid.size)) << grid.name;
          EXPECT_LT(FindLargestDifference(inRows.v, plain.v), 100 * rounding) << grid.name;
          EXPECT_NEAR(inRows.velocityErrors, plain.velocityErrors, 0.01 * plain.velocityErrors + 1e-9) << grid.name;
        }
      }
    }
  }
}

TYPED_TEST(GridTest, GivesTheSameBitsInAnyWidth) {
  using Real = TypeParam;
  for (const Blueprint& grid : MakeGrids()) {
    Problem<Real> alone(grid);
    alone.Push();
    alone.Tear(11);
    alone.StepInRows(3, FindSweepKernels<Real>(1).front());
    for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
      Problem<Real> wide(grid);
      wide.Push();
      wide.Tear(11);
      wide.StepInRows(3, kernel);
      EXPECT_TRUE(wide.x == alone.x && wide.v == alone.v) << grid.name << ", " << kernel.width << " lanes";
      EXPECT_EQ(wide.velocityErrors, alone.velocityErrors) << grid.name << ", " << kernel.width << " lanes";
      EXPECT_EQ(wide.accelerationErrors, alone.accelerationErrors) << grid.name << ", " << kernel.width << " lanes";
    }
  }
}

// A torn spring gives the same bits as a blueprint without that spring.
TYPED_TEST(GridTest, WhatIsTornIsAsIfItHadNeverBeen) {
  using Real = TypeParam;
  const Blueprint sheet = MakeSheet({21, 9}, Pinned::kEdge, 0);
  Problem<Real> torn(sheet);
  torn.Tear(4);
  const Blueprint left = MakeTornBlueprint(sheet, torn.torn);
  Problem<Real> rebuilt(left);
  torn.StepInRows(3, FindSweepKernels<Real>(kWidestPack).back());
  rebuilt.StepInRows(3, FindSweepKernels<Real>(kWidestPack).back());
  EXPECT_TRUE(torn.x == rebuilt.x && torn.v == rebuilt.v);
}

TYPED_TEST(GridTest, WindFindsTheFacesThatAreLeft) {
  using Real = TypeParam;
  const Blueprint sheet = MakeSheet({19, 8}, Pinned::kEdge, 0.6);
  Problem<Real> torn(sheet);
  torn.Tear(6);
  const Blueprint left = MakeTornBlueprint(sheet, torn.torn);
  ASSERT_LT(left.full.faces.size(), sheet.full.faces.size());
  Problem<Real> plain(left);
  Problem<Real> inRows(left);
  plain.StepPlainly(4);
  inRows.StepInRows(4, FindSweepKernels<Real>(kWidestPack).back());
  EXPECT_LT(FindLargestDifference(inRows.x, plain.x), sizeof(Real) == 4 ? 4e-6 : 1e-14);
}

TYPED_TEST(GridTest, HingesThatAreLeftBend) {
  using Real = TypeParam;
  const Blueprint sheet = MakeSheet({19, 8}, Pinned::kEdge, 0, 0, 0.2);
  Problem<Real> torn(sheet);
  torn.Tear(6);
  const Blueprint left = MakeTornBlueprint(sheet, torn.torn);
  ASSERT_LT(left.full.hinges.size(), sheet.full.hinges.size());
  ASSERT_GT(left.full.hinges.size(), 0U);
  Problem<Real> plain(left);
  Problem<Real> inRows(left);
  plain.StepPlainly(4);
  inRows.StepInRows(4, FindSweepKernels<Real>(kWidestPack).back());
  EXPECT_LT(FindLargestDifference(inRows.x, plain.x), sizeof(Real) == 4 ? 4e-6 : 1e-14);
}

TEST(Grid, RefusesWhatTheSweepDoesNotKnow) {
  EXPECT_EQ(MakeBall(MakeMeasuredBall()).singleGridPlan.rows, 0U);
  EXPECT_EQ(MakePair({}).singleGridPlan.rows, 0U);
  const auto countRows = [](Blueprint& body) {
    FinishBlueprint(body);
    EXPECT_EQ(body.singleGridPlan.rows, body.fullGridPlan.rows);
    return body.fullGridPlan.rows;
  };
  Blueprint body = MakeSheet({8, 6}, Pinned::kNone, 0.6);
  EXPECT_GT(countRows(body), 0U);
  Blueprint changed = body;
  changed.full.repulsion = 1e-3;
  EXPECT_EQ(countRows(changed), 0U);
  changed = body;
  changed.full.springs.push_back(changed.full.springs[3]);
  EXPECT_EQ(countRows(changed), 0U) << "two springs in one place";
  changed = body;
  changed.full.faces.push_back({0, 1, 47});
  EXPECT_EQ(countRows(changed), 0U) << "no half of a square";
  changed = MakeSheet({8, 6}, Pinned::kNone, 0.6, 0, 0.2);
  EXPECT_GT(countRows(changed), 0U);
  changed.full.hinges.push_back(changed.full.hinges[3]);
  EXPECT_EQ(countRows(changed), 0U) << "two hinges in one place";
  changed.full.hinges.back().vertices = {0, 3, 3, 6};
  EXPECT_EQ(countRows(changed), 0U) << "too many kinds of hinges";
  changed = body;
  for (std::uint32_t other = 9; other < 48; ++other) changed.full.springs.push_back({0, other, 1, 1, 0});
  EXPECT_EQ(countRows(changed), 0U) << "too many directions";
}

}  // namespace
}  // namespace wobble::physics
