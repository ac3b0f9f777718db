// The exact predicate against cases whose answer is known, against cases that double precision gets wrong, and against
// an oracle that decides by another way: it cuts the line of both planes by rational parameters and compares intervals.
#include "tests/bench/intersections/triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "tests/bench/random.h"

namespace wobble::bench {
namespace {

using physics::Vector3d;
using Rational = boost::multiprecision::cpp_rational;
using Corners = std::array<Vector3d, 3>;
using ExactCorners = std::array<ExactPoint, 3>;
using RationalVector = std::array<Rational, 3>;

ExactCorners MakeExact(const Corners& corners, const Vector3d& origin = Vector3d::Zero()) {
  ExactCorners exact;
  for (std::size_t i = 0; i < 3; ++i) exact[i] = AddExactly(origin, corners[i]);
  return exact;
}

Triangle Point(const ExactCorners& corners) { return {&corners[0], &corners[1], &corners[2]}; }

// In every order of the triangles and of their corners, which must not matter.
Crossing FindInAnyOrder(const ExactCorners& s, const ExactCorners& t) {
  SignCounts counts;
  const Crossing first = FindCrossing(Point(s), Point(t), counts);
  std::array<std::size_t, 3> a{0, 1, 2};
  do {
    std::array<std::size_t, 3> b{0, 1, 2};
    do {
      const Triangle one{&s[a[0]], &s[a[1]], &s[a[2]]};
      const Triangle other{&t[b[0]], &t[b[1]], &t[b[2]]};
      EXPECT_EQ(FindCrossing(one, other, counts), first);
      EXPECT_EQ(FindCrossing(other, one, counts), first);
    } while (std::next_permutation(b.begin(), b.end()));
  } while (std::next_permutation(a.begin(), a.end()));
  return first;
}

Crossing Find(const Corners& s, const Corners& t) { return FindInAnyOrder(MakeExact(s), MakeExact(t)); }

// --- the oracle ---

RationalVector Read(const ExactPoint& p) {
  RationalVector v;
  for (std::size_t i = 0; i < 3; ++i) v[i] = Rational(p.near[i]) + Rational(p.rest[i]);
  return v;
}

RationalVector Subtract(const RationalVector& a, const RationalVector& b) {
  return {Rational(a[0] - b[0]), Rational(a[1] - b[1]), Rational(a[2] - b[2])};
}

RationalVector Cross(const RationalVector& a, const RationalVector& b) {
  return {Rational(a[1] * b[2] - a[2] * b[1]), Rational(a[2] * b[0] - a[0] * b[2]),
          Rational(a[0] * b[1] - a[1] * b[0])};
}

Rational Dot(const RationalVector& a, const RationalVector& b) {
  return Rational(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

using RationalTriangle = std::array<RationalVector, 3>;

RationalVector FindNormal(const RationalTriangle& t) { return Cross(Subtract(t[1], t[0]), Subtract(t[2], t[0])); }

bool IsZero(const RationalVector& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

// The open interval along `direction` in which the plane through `point` cuts the triangle's interior; none if it does
// not.
struct Interval {
  Rational begin, end;
};
std::optional<Interval> FindCut(const RationalTriangle& t, const RationalVector& normal, const RationalVector& point,
                                const RationalVector& direction) {
  std::vector<Rational> ends;
  std::array<Rational, 3> heights;
  for (std::size_t i = 0; i < 3; ++i) heights[i] = Dot(normal, Subtract(t[i], point));
  if (*std::min_element(heights.begin(), heights.end()) >= 0) return {};
  if (*std::max_element(heights.begin(), heights.end()) <= 0) return {};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Rational from = Dot(direction, t[i]);
    const Rational to = Dot(direction, t[j]);
    if (heights[i] == 0) ends.push_back(from);
    if (heights[i].sign() * heights[j].sign() < 0) {
      ends.emplace_back(from + (to - from) * heights[i] / (heights[i] - heights[j]));
    }
  }
  const auto [least, most] = std::minmax_element(ends.begin(), ends.end());
  return Interval{*least, *most};
}

// Only for triangles that are not in one plane.
bool CrossesByIntervals(const ExactCorners& one, const ExactCorners& other) {
  RationalTriangle s, t;
  for (std::size_t i = 0; i < 3; ++i) {
    s[i] = Read(one[i]);
    t[i] = Read(other[i]);
  }
  const RationalVector ofS = FindNormal(s);
  const RationalVector ofT = FindNormal(t);
  const RationalVector direction = Cross(ofS, ofT);
  if (IsZero(direction)) return false;
  const auto cutS = FindCut(s, ofT, t[0], direction);
  const auto cutT = FindCut(t, ofS, s[0], direction);
  if (!cutS || !cutT) return false;
  return std::max(cutS->begin, cutT->begin) < std::min(cutS->end, cutT->end);
}

// --- known answers ---

const Corners kFlat{Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, 4, 0)};

TEST(Triangles, OnesThatPassThroughEachOtherCross) {
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, -1), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}), Crossing::kThrough);
  // One that is pierced by a needle, and one whose side is cut.
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, -9), Vector3d(1.001, 1, 9), Vector3d(1, 1.001, 9)}), Crossing::kThrough);
  EXPECT_EQ(Find(kFlat, {Vector3d(-1, 1, -1), Vector3d(-1, 1, 1), Vector3d(1, 1, 0.5)}), Crossing::kThrough);
  // A corner in the other's plane, beside it.
  EXPECT_EQ(Find(kFlat, {Vector3d(-1, 1, 0), Vector3d(2, 1, 1), Vector3d(2, 1, -1)}), Crossing::kThrough);
}

TEST(Triangles, OnesThatTouchDoNot) {
  // A corner in the area, a corner at a side, corner at corner.
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 0), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}), Crossing::kNone);
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 0, 0), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}), Crossing::kNone);
  EXPECT_EQ(Find(kFlat, {Vector3d(0, 0, 0), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}), Crossing::kNone);
  // A side in the area; sides that cross in a point, one triangle above and the other beside.
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 0), Vector3d(2, 1, 0), Vector3d(1, 1, 1)}), Crossing::kNone);
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 0, -1), Vector3d(1, 0, 1), Vector3d(1, -1, 0)}), Crossing::kNone);
  // Intervals on the common line that only meet end to end.
  EXPECT_EQ(Find(kFlat, {Vector3d(-1, 1, -1), Vector3d(-1, 1, 1), Vector3d(0, 1, 0)}), Crossing::kNone);
}

TEST(Triangles, OnesApartDoNot) {
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 1), Vector3d(2, 1, 1), Vector3d(1, 2, 1)}), Crossing::kNone);
  // Each on both sides of the other's plane, and yet apart.
  EXPECT_EQ(Find(kFlat, {Vector3d(5, 1, -1), Vector3d(5, 1, 1), Vector3d(6, 1, 1)}), Crossing::kNone);
}

TEST(Triangles, OnesInOnePlaneOverlapByArea) {
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 0), Vector3d(3, 1, 0), Vector3d(1, 3, 0)}), Crossing::kInPlane);
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 0), Vector3d(1.5, 1, 0), Vector3d(1, 1.5, 0)}), Crossing::kInPlane);
  EXPECT_EQ(Find(kFlat, kFlat), Crossing::kInPlane);
  EXPECT_EQ(Find(kFlat, {Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, -4, 0)}), Crossing::kNone);  // side by side
  EXPECT_EQ(Find(kFlat, {Vector3d(2, 2, 0), Vector3d(9, 2, 0), Vector3d(9, 9, 0)}), Crossing::kNone);  // corner at side
  EXPECT_EQ(Find(kFlat, {Vector3d(3, 3, 0), Vector3d(9, 3, 0), Vector3d(9, 9, 0)}), Crossing::kNone);  // apart
}

TEST(Triangles, OnesWithoutAreaMeetNothing) {
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, -1), Vector3d(1, 1, 0), Vector3d(1, 1, 1)}), Crossing::kNone);
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 0), Vector3d(2, 1, 0), Vector3d(3, 1, 0)}), Crossing::kNone);
  EXPECT_EQ(Find(kFlat, {Vector3d(1, 1, 0), Vector3d(1, 1, 0), Vector3d(1, 1, 0)}), Crossing::kNone);
}

// Corners that both triangles have are the same point in memory, as in a skin.
TEST(Triangles, ACornerInCommonIsNoCrossing) {
  const ExactCorners a = MakeExact(kFlat);
  const auto look = [&](const std::vector<Vector3d>& others, std::size_t shared) {
    ExactCorners b;
    Triangle t{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (i < shared) {
        t[i] = &a[i];
      } else {
        b[i] = AddExactly(Vector3d::Zero(), others[i - shared]);
        t[i] = &b[i];
      }
    }
    SignCounts counts;
    const Crossing found = FindCrossing(Point(a), t, counts);
    EXPECT_EQ(FindCrossing(t, Point(a), counts), found);
    EXPECT_EQ(FindCrossing({t[2], t[0], t[1]}, {&a[1], &a[0], &a[2]}, counts), found);
    return found;
  };
  EXPECT_EQ(look({Vector3d(1, 1, 1), Vector3d(2, 1, 1)}, 1), Crossing::kNone);
  EXPECT_EQ(look({Vector3d(1, 1, 1), Vector3d(2, 1, -1)}, 1), Crossing::kThrough);   // cuts on from the corner
  EXPECT_EQ(look({Vector3d(-1, -1, 1), Vector3d(-2, -1, -1)}, 1), Crossing::kNone);  // cuts the other way
  EXPECT_EQ(look({Vector3d(-1, -1, 0), Vector3d(-2, -1, 0)}, 1), Crossing::kNone);   // in one plane, opposite
  EXPECT_EQ(look({Vector3d(1, 2, 0), Vector3d(2, 1, 0)}, 1), Crossing::kInPlane);    // in one plane, upon it
  EXPECT_EQ(look({Vector3d(1, 1, 1)}, 2), Crossing::kNone);                          // a hinge
  EXPECT_EQ(look({Vector3d(1, 1, 1e-300)}, 2), Crossing::kNone);                     // a hinge that is all but shut
  EXPECT_EQ(look({Vector3d(1, -1, 0)}, 2), Crossing::kNone);                         // a hinge laid open
  EXPECT_EQ(look({Vector3d(1, 1, 0)}, 2), Crossing::kInPlane);                       // folded flat
}

// --- where double precision is not enough ---

// The sum of products as plain code would take it.
int FindSideByDoubles(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const double volume = (b - a).cross(c - a).dot(p - a);
  return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}

// Points within a few units of rounding of a plane that goes through none of the axes.
TEST(Triangles, SidesAreRightWhereDoublesAreWrong) {
  Random random(3);
  int wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&] { return Vector3d(random.Draw(0, 1), random.Draw(0, 1), random.Draw(0, 1)); };
    const Vector3d a = draw(), b = draw(), c = draw();
    const double s = random.Draw(-1, 1), t = random.Draw(-1, 1);
    Vector3d p = a + s * (b - a) + t * (c - a);
    for (Eigen::Index axis = 0; axis < 3; ++axis) p[axis] += std::ldexp(random.DrawWhole(-2, 2), -53);
    SignCounts counts;
    const Vector3d none = Vector3d::Zero();
    const ExactPoint points[] = {AddExactly(none, a), AddExactly(none, b), AddExactly(none, c), AddExactly(none, p)};
    const RationalVector from = Read(points[0]);
    const Rational volume =
        Dot(Cross(Subtract(Read(points[1]), from), Subtract(Read(points[2]), from)), Subtract(Read(points[3]), from));
    const int exact = volume.sign();
    ASSERT_EQ(FindSideExactly(points[0], points[1], points[2], points[3]), exact);
    ASSERT_EQ(FindSide(points[0], points[1], points[2], points[3], counts), exact);
    wrong += FindSideByDoubles(a, b, c, p) != exact ? 1 : 0;
  }
  EXPECT_GT(wrong, 100) << "the cases are too easy";
}

// Two triangles of one plane with their sides on one line but for the rounding of the corners of one.
TEST(Triangles, OverlapsAreRightWhereDoublesAreWrong) {
  Random random(19);
  int overlapping = 0;
  int apart = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d a(random.Draw(0, 1), 0, random.Draw(0, 1));
    const Vector3d b(random.Draw(2, 3), 0, random.Draw(0, 1));
    const auto beside = [&](double share) {
      return Vector3d(a + share * (b - a) + std::ldexp(random.DrawWhole(-2, 2), -53) * Vector3d::UnitZ());
    };
    const ExactCorners above = MakeExact({a, b, Vector3d(1.5, 0, 4)});
    const ExactCorners below = MakeExact({beside(0.3), beside(0.6), Vector3d(1.5, 0, -4)});
    const RationalVector side = Subtract(Read(above[1]), Read(above[0]));
    const auto isAbove = [&](const ExactPoint& p) {
      const RationalVector way = Subtract(Read(p), Read(above[0]));
      return side[0] * way[2] - side[2] * way[0] > 0;
    };
    const bool overlaps = isAbove(below[0]) || isAbove(below[1]);
    SignCounts counts;
    ASSERT_EQ(FindCrossing(Point(above), Point(below), counts), overlaps ? Crossing::kInPlane : Crossing::kNone);
    ASSERT_EQ(FindCrossing(Point(below), Point(above), counts), overlaps ? Crossing::kInPlane : Crossing::kNone);
    (overlaps ? overlapping : apart) += 1;
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_GT(apart, 100);
}

// A float a hundred metres from its body's origin: the sum is no double, and the rest decides.
TEST(Triangles, ThePartThatRoundingLeavesOutDecides) {
  const double above = std::ldexp(1, -60);  // m, far less than the distance of doubles at 100 m
  const Vector3d origin(96, 96, 96);
  const ExactCorners flat = MakeExact(kFlat, origin);
  const auto needle = [&](double depth) {
    return MakeExact({Vector3d(1, 1, depth), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}, origin);
  };
  EXPECT_EQ(needle(above)[0].near, needle(-above)[0].near);
  EXPECT_EQ(FindInAnyOrder(flat, needle(above)), Crossing::kNone);
  EXPECT_EQ(FindInAnyOrder(flat, needle(0)), Crossing::kNone);
  EXPECT_EQ(FindInAnyOrder(flat, needle(-above)), Crossing::kThrough);
}

TEST(Triangles, SumsAreExact) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const double origin = random.Draw(-1, 1) * std::ldexp(1, random.DrawWhole(-20, 20));
    const double local = random.Draw(-1, 1) * std::ldexp(1, random.DrawWhole(-40, 20));
    const ExactPoint p = AddExactly(Vector3d(origin, 0, 0), Vector3d(local, 0, 0));
    EXPECT_EQ(Rational(p.near[0]) + Rational(p.rest[0]), Rational(origin) + Rational(local));
    EXPECT_EQ(p.near[0], origin + local);
  }
  EXPECT_EQ(Rational(0.1), Rational(boost::multiprecision::cpp_int(3602879701896397LL),
                                    boost::multiprecision::cpp_int(36028797018963968LL)));
  EXPECT_FALSE(AddExactly(Vector3d(INFINITY, 0, 0), Vector3d::Zero()).IsFinite());
}

// --- against the oracle ---

struct Agreement {
  int crossing = 0;
  int exact = 0;
};

// Random triangles whose corners are drawn by `draw`.
template <class Draw>
Agreement Compare(int count, const Draw& draw) {
  Agreement agreement;
  for (int i = 0; i < count; ++i) {
    const ExactCorners s = draw();
    const ExactCorners t = draw();
    SignCounts counts;
    const Crossing found = FindCrossing(Point(s), Point(t), counts);
    const bool crosses = CrossesByIntervals(s, t);
    EXPECT_EQ(found == Crossing::kThrough, crosses) << "pair " << i;
    agreement.crossing += crosses ? 1 : 0;
    agreement.exact += counts.exact > 0 ? 1 : 0;
  }
  return agreement;
}

TEST(Triangles, AgreesWithTheOracleOnTrianglesAnywhere) {
  Random random(11);
  const Agreement agreement = Compare(1500, [&] {
    Corners corners;
    for (Vector3d& p : corners) p = Vector3d(random.Draw(0, 1), random.Draw(0, 1), random.Draw(0, 1));
    return MakeExact(corners, Vector3d(32.5, -7.25, 0.125));
  });
  EXPECT_GT(agreement.crossing, 100);
  EXPECT_EQ(agreement.exact, 0) << "doubles suffice here";
}

// On a grid of three points a side corners lie in planes, on sides and on corners most of the time.
TEST(Triangles, AgreesWithTheOracleOnAGrid) {
  Random random(13);
  const Agreement agreement = Compare(4000, [&] {
    Corners corners;
    for (Vector3d& p : corners) {
      p = Vector3d(random.DrawWhole(0, 2), random.DrawWhole(0, 2), random.DrawWhole(0, 2)) / 8;
    }
    return MakeExact(corners);
  });
  EXPECT_GT(agreement.crossing, 100);
  EXPECT_GT(agreement.exact, 100);
}

// The same grid, with corners off it by less than doubles at that place can tell.
TEST(Triangles, AgreesWithTheOracleBesideAGrid) {
  Random random(17);
  const Agreement agreement = Compare(2000, [&] {
    ExactCorners corners;
    for (ExactPoint& p : corners) {
      const Vector3d off(random.DrawWhole(-1, 1), random.DrawWhole(-1, 1), random.DrawWhole(-1, 1));
      p = AddExactly(Vector3d(100 + random.DrawWhole(0, 2), random.DrawWhole(0, 2), 50 + random.DrawWhole(0, 2)),
                     std::ldexp(1, -58) * off);
    }
    return corners;
  });
  EXPECT_GT(agreement.crossing, 100);
  EXPECT_GT(agreement.exact, 100);
}

// Triangles so small that their corners, as doubles, are a few steps apart.
TEST(Triangles, AgreesWithTheOracleOnTinyTriangles) {
  Random random(23);
  const Agreement agreement = Compare(1000, [&] {
    Corners corners;
    for (Vector3d& p : corners) p = 1e-13 * Vector3d(random.Draw(0, 1), random.Draw(0, 1), random.Draw(0, 1));
    return MakeExact(corners, Vector3d(100, 75, 50));
  });
  EXPECT_GT(agreement.crossing, 50);
  EXPECT_GT(agreement.exact, 100);
}

}  // namespace
}  // namespace wobble::bench
