// Every decision is the sign of a determinant of the corners' coordinates, in space or projected along an axis. Double
// precision decides where the determinant is larger than a bound on its error; otherwise it is computed in whole
// numbers of any length, with a power of two as the common denominator of all coordinates: rational numbers that need
// no greatest common divisor, which took most of the time.
//
// The bound. Let m be the largest of the nine differences of coordinates as computed, u = 2⁻⁵³, and ρ the largest
// `rest` of the four points. A computed difference is off by at most E = u m + 2ρ. A determinant of nine entries of at
// most m, each off by at most E, is off by at most 6 ((m + E)³ − m³). Evaluating it by cofactors adds at most 8u times
// the sum of the absolute products, which is at most 6 m³ (Shewchuk 1997, section 4.3). In the plane: 2 ((m + E)² − m²)
// and 4u times 2 m². A factor of 1.01 covers the rounding of the bound itself. Numbers so small that products could
// lose bits to underflow are left to the whole numbers.
//
// Two triangles that are not in one plane, and each of which has corners on both sides of the other's plane, cut the
// line that the planes have in common in an interval each; they intersect if the open intervals overlap. Let s₀ be the
// corner of s that is alone on its side of t, t₀ likewise, wound so that both are on the positive side. Then s cuts the
// line between its sides s₀s₂ and s₀s₁, t between t₀t₁ and t₀t₂, in the order of the line's direction Nₛ × Nₜ. Which of
// two such cuts comes first is the sign of the volume that the two sides span (Guigue & Devillers 2003). So the
// intervals overlap if s₀ s₁ t₀ t₁ has a negative volume and s₀ s₂ t₀ t₂ a positive one.
#include "tests/bench/intersections/triangles.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>

namespace wobble::bench {
namespace {

using Whole = boost::multiprecision::cpp_int;

constexpr double kUnit = 0x1p-53;
constexpr double kSlack = 1.01;
// The third power of this is far above the smallest normal number over u.
constexpr double kTooSmall = 1e-80;

// Differences of three points from the first, with what bounds their error.
struct Differences {
  std::array<std::array<double, 3>, 3> rows{};
  double most = 0;  // m
  double rest = 0;  // ρ

  [[nodiscard]] double Error() const { return kUnit * most + 2 * rest; }
};

double FindRest(const ExactPoint& p) {
  return std::max({std::fabs(p.rest[0]), std::fabs(p.rest[1]), std::fabs(p.rest[2])});
}

template <class... Points>
Differences Subtract(const ExactPoint& from, const Points&... points) {
  Differences d;
  d.rest = FindRest(from);
  std::size_t row = 0;
  const auto add = [&](const ExactPoint& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      d.rows[row][axis] = p.near[axis] - from.near[axis];
      d.most = std::max(d.most, std::fabs(d.rows[row][axis]));
    }
    d.rest = std::max(d.rest, FindRest(p));
    ++row;
  };
  (add(points), ...);
  return d;
}

template <class Number>
Number FindMinor(const std::array<Number, 3>& a, const std::array<Number, 3>& b, std::size_t i, std::size_t j) {
  return Number(a[i] * b[j]) - Number(a[j] * b[i]);
}

template <class Number>
Number FindDeterminant(const std::array<std::array<Number, 3>, 3>& rows) {
  return Number(rows[2][0] * FindMinor(rows[0], rows[1], 1, 2)) -
         Number(rows[2][1] * FindMinor(rows[0], rows[1], 0, 2)) +
         Number(rows[2][2] * FindMinor(rows[0], rows[1], 0, 1));
}

constexpr int kMantissaBits = 53;

// The exponent of the last bit of any part of the points: all are whole multiples of two to this power.
template <class... Points>
int FindLastBit(const Points&... points) {
  int last = std::numeric_limits<int>::max();
  const auto look = [&last](double value) {
    int exponent = 0;
    if (value == 0) return;
    (void)std::frexp(value, &exponent);
    last = std::min(last, exponent - kMantissaBits);
  };
  const auto lookAt = [&look](const ExactPoint& p) {
    for (std::size_t i = 0; i < 3; ++i) {
      look(p.near[i]);
      look(p.rest[i]);
    }
  };
  (lookAt(points), ...);
  return last;
}

// value / 2^lastBit.
Whole Scale(double value, int lastBit) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  if (mantissa == 0) return 0;
  return Whole(static_cast<std::int64_t>(std::ldexp(mantissa, kMantissaBits))) << (exponent - kMantissaBits - lastBit);
}

std::array<Whole, 3> SubtractExactly(const ExactPoint& p, const ExactPoint& from, int lastBit) {
  std::array<Whole, 3> row;
  for (std::size_t i = 0; i < 3; ++i) {
    row[i] = Scale(p.near[i], lastBit);
    row[i] += Scale(p.rest[i], lastBit);
    row[i] -= Scale(from.near[i], lastBit);
    row[i] -= Scale(from.rest[i], lastBit);
  }
  return row;
}

int FindSign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// True if some axis has no differences at all, which needs no bound: equal doubles are equal.
bool IsFlat(const Differences& d) {
  for (std::size_t axis = 0; d.rest == 0 && axis < 3; ++axis) {
    if (d.rows[0][axis] == 0 && d.rows[1][axis] == 0 && d.rows[2][axis] == 0) return true;
  }
  return false;
}

// The two axes that are left when `axis` is projected away.
struct Plane {
  std::size_t first, second;
};
constexpr std::array<Plane, 3> kPlanes{{{1, 2}, {2, 0}, {0, 1}}};

// Sign of the projected area of a, b, c: 1 counter-clockwise.
int FindTurn(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, Plane plane, SignCounts& counts) {
  if (&a == &b || &b == &c || &c == &a) return 0;
  ++counts.asked;
  const Differences d = Subtract(a, b, c);
  const double turn = FindMinor(d.rows[0], d.rows[1], plane.first, plane.second);
  const double error = d.Error();
  const double bound = kSlack * (2 * (2 * d.most * error + error * error) + 8 * kUnit * d.most * d.most);
  if (d.most > kTooSmall && std::fabs(turn) > bound) return FindSign(turn);
  ++counts.exact;
  const int lastBit = FindLastBit(a, b, c);
  return FindMinor(SubtractExactly(b, a, lastBit), SubtractExactly(c, a, lastBit), plane.first, plane.second).sign();
}

using Signs = std::array<int, 3>;

Signs FindSides(const Triangle& plane, const Triangle& of, SignCounts& counts) {
  Signs signs{};
  for (std::size_t i = 0; i < 3; ++i) signs[i] = FindSide(*plane[0], *plane[1], *plane[2], *of[i], counts);
  return signs;
}

bool HasBoth(const Signs& signs) {
  return *std::min_element(signs.begin(), signs.end()) < 0 && *std::max_element(signs.begin(), signs.end()) > 0;
}

bool AreAllZero(const Signs& signs) { return signs == Signs{0, 0, 0}; }

// The corner that is alone on its side, where there are corners on both.
std::size_t FindAlone(const Signs& signs) {
  const auto positive = std::count(signs.begin(), signs.end(), 1);
  const int sign = positive == 1 ? 1 : -1;
  return static_cast<std::size_t>(std::find(signs.begin(), signs.end(), sign) - signs.begin());
}

Triangle TurnTo(const Triangle& t, std::size_t first) { return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]}; }

// Whether a side of s, wound counter-clockwise if `winding` is 1, has no corner of t on its inner side.
bool HasSeparatingSide(const Triangle& s, const Triangle& t, int winding, Plane plane, SignCounts& counts) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto isInner = [&](const ExactPoint* corner) {
      return FindTurn(*s[i], *s[(i + 1) % 3], *corner, plane, counts) == winding;
    };
    if (std::none_of(t.begin(), t.end(), isInner)) return true;
  }
  return false;
}

// Triangles of one plane: convex areas are disjoint if a line along a side of one of them separates them.
bool OverlapsInPlane(const Triangle& s, const Triangle& t, SignCounts& counts) {
  for (const Plane plane : kPlanes) {
    const int windingS = FindTurn(*s[0], *s[1], *s[2], plane, counts);
    if (windingS == 0) continue;  // the plane is seen edge on, or s has no area
    const int windingT = FindTurn(*t[0], *t[1], *t[2], plane, counts);
    return windingT != 0 && !HasSeparatingSide(s, t, windingS, plane, counts) &&
           !HasSeparatingSide(t, s, windingT, plane, counts);
  }
  return false;
}

}  // namespace

bool ExactPoint::IsFinite() const {
  const auto isFinite = [](double value) { return std::isfinite(value); };
  return std::all_of(near.begin(), near.end(), isFinite) && std::all_of(rest.begin(), rest.end(), isFinite);
}

ExactPoint AddExactly(const physics::Vector3d& origin, const physics::Vector3d& local) {
  ExactPoint p;
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = origin[static_cast<Eigen::Index>(i)];
    const double b = local[static_cast<Eigen::Index>(i)];
    const double sum = a + b;
    const double ofB = sum - a;
    p.near[i] = sum;
    p.rest[i] = (a - (sum - ofB)) + (b - ofB);
  }
  return p;
}

int FindSideExactly(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p) {
  const int lastBit = FindLastBit(a, b, c, p);
  const std::array<std::array<Whole, 3>, 3> rows{SubtractExactly(b, a, lastBit), SubtractExactly(c, a, lastBit),
                                                 SubtractExactly(p, a, lastBit)};
  return FindDeterminant(rows).sign();
}

int FindSide(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p, SignCounts& counts) {
  if (&a == &b || &a == &c || &a == &p || &b == &c || &b == &p || &c == &p) return 0;
  ++counts.asked;
  const Differences d = Subtract(a, b, c, p);
  const double volume = FindDeterminant(d.rows);
  const double m = d.most;
  const double e = d.Error();
  const double bound = kSlack * (6 * e * (3 * m * m + 3 * m * e + e * e) + 48 * kUnit * m * m * m);
  if (m > kTooSmall && std::fabs(volume) > bound) return FindSign(volume);
  if (IsFlat(d)) return 0;
  ++counts.exact;
  return FindSideExactly(a, b, c, p);
}

Crossing FindCrossing(const Triangle& s, const Triangle& t, SignCounts& counts) {
  const Signs ofS = FindSides(t, s, counts);
  if (!HasBoth(ofS)) {
    return AreAllZero(ofS) && OverlapsInPlane(s, t, counts) ? Crossing::kInPlane : Crossing::kNone;
  }
  const Signs ofT = FindSides(s, t, counts);
  if (!HasBoth(ofT)) return Crossing::kNone;
  const std::size_t firstS = FindAlone(ofS);
  const std::size_t firstT = FindAlone(ofT);
  Triangle first = TurnTo(s, firstS);
  Triangle second = TurnTo(t, firstT);
  if (ofS[firstS] < 0) std::swap(second[1], second[2]);
  if (ofT[firstT] < 0) std::swap(first[1], first[2]);
  const bool overlaps = FindSide(*first[0], *first[1], *second[0], *second[1], counts) < 0 &&
                        FindSide(*first[0], *first[2], *second[0], *second[2], counts) > 0;
  return overlaps ? Crossing::kThrough : Crossing::kNone;
}

}  // namespace wobble::bench
