// The survey of a body against sums made vertex by vertex, for numbers of vertices that fill whole vectors or do not.
#include "server/physics/model/survey.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace wobble::physics {
namespace {

template <class Real>
struct Cloud {
  explicit Cloud(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = static_cast<double>(i);
      masses.push_back(static_cast<Real>(0.5 + 0.1 * std::fabs(std::sin(at))));
      x.push_back(Vector3d(std::sin(1.3 * at), std::cos(0.7 * at) - 2, 0.1 * at).cast<Real>());
      v.push_back(Vector3d(3 * std::sin(at), std::sin(2.1 * at), 1 - 0.2 * at).cast<Real>());
    }
  }
  [[nodiscard]] Survey<Real> Look() const { return MakeSurvey<Real>(masses, x, v); }

  std::vector<Real> masses;
  std::vector<Vector3<Real>> x;
  std::vector<Vector3<Real>> v;
};

template <class Real>
class SurveyTest : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(SurveyTest, Precisions);

TYPED_TEST(SurveyTest, TellsWhatSumsOneByOneTell) {
  using Real = TypeParam;
  const double rounding = sizeof(Real) == 4 ? 3e-6 : 1e-14;
  for (std::size_t count = 1; count < 40; ++count) {
    const Cloud<Real> cloud(count);
    const Survey<Real> survey = cloud.Look();
    double mass = 0;
    double energy = 0;
    Vector3d centre = Vector3d::Zero();
    Vector3d velocity = Vector3d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const double m = double{cloud.masses[i]};
      mass += m;
      centre += m * cloud.x[i].template cast<double>();
      velocity += m * cloud.v[i].template cast<double>();
      energy += m * cloud.v[i].template cast<double>().squaredNorm() / 2;
    }
    centre /= mass;
    velocity /= mass;
    Real fastest = 0;
    double farthest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      fastest = std::max(fastest, cloud.v[i].norm());
      farthest = std::max(farthest, (cloud.v[i].template cast<double>() - velocity).norm());
      EXPECT_TRUE((cloud.x[i].array() >= survey.bounds.low.array()).all()) << count;
      EXPECT_TRUE((cloud.x[i].array() <= survey.bounds.high.array()).all()) << count;
    }
    EXPECT_LT((survey.bulk.centre - centre).norm(), rounding * (1 + centre.norm())) << count;
    EXPECT_LT((survey.bulk.velocity - velocity).norm(), rounding * (1 + velocity.norm())) << count;
    EXPECT_NEAR(survey.bulk.kineticEnergy, energy, rounding * energy) << count;
    const BulkMotion bulk = FindBulkMotion<Real>(cloud.masses, cloud.x, cloud.v);
    EXPECT_EQ(bulk.centre, survey.bulk.centre) << count;
    EXPECT_EQ(bulk.velocity, survey.bulk.velocity) << count;
    EXPECT_EQ(bulk.kineticEnergy, survey.bulk.kineticEnergy) << count;
    EXPECT_NEAR(double{survey.bounds.speed}, double{fastest}, rounding * double{fastest}) << count;
    EXPECT_NEAR(double{survey.agitation}, farthest, 10 * rounding * (1 + farthest)) << count;
  }
}

TYPED_TEST(SurveyTest, SeesAVertexThatIsNoNumberWhereverItStands) {
  using Real = TypeParam;
  for (std::size_t bad = 0; bad < 19; ++bad) {
    Cloud<Real> nowhere(19);
    nowhere.x[bad].y() = std::numeric_limits<Real>::quiet_NaN();
    EXPECT_FALSE(nowhere.Look().bulk.centre.allFinite()) << bad;
    Cloud<Real> racing(19);
    racing.v[bad].z() = std::numeric_limits<Real>::infinity();
    EXPECT_FALSE(std::isfinite(racing.Look().bulk.kineticEnergy)) << bad;
  }
}

}  // namespace
}  // namespace wobble::physics
