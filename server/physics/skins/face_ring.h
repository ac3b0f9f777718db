// A point and the faces round a vertex of a skin, all of them side by side in the lanes of a vector: a vertex has some
// six. The numbers of lanes are those of the program's baseline, whatever the processor has. Products and sums stand in
// the order of the plain code, none of them fused, so that both give the same bits.
//
// For the units of face search alone.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "server/physics/lanes/lanes.h"
#include "server/physics/lanes/vertex_rows.h"
#include "server/physics/skins/face_search.h"

namespace wobble::physics {

template <class Real>
inline constexpr std::size_t kFacesAtOnce = sizeof(typename RowsOf<Real>::Lanes) / sizeof(Real);

// One number of each face.
template <class Real>
using OfEachFace = std::array<Real, kFacesAtOnce<Real>>;

// Up to kFacesAtOnce faces, seen from a point.
template <class Real>
class FaceRing {
 public:
  // faces: at least one; those beyond kFacesAtOnce are left out.
  FaceRing(const Skin<Real>& skin, std::span<const std::uint16_t> faces, const Vector3<Real>& p)
      : m_side(skin.side), m_offset(skin.offset), m_faces(faces.first(std::min(faces.size(), kFacesAtOnce<Real>))) {
    std::array<const Face*, kFacesAtOnce<Real>> all;  // lanes without a face repeat the last one
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = &skin.faces[m_faces[std::min(i, m_faces.size() - 1)]];
    m_a = ReadCorners(skin, all, 0);
    m_b = ReadCorners(skin, all, 1);
    m_c = ReadCorners(skin, all, 2);
    m_p = {Spread<Lanes>(p[0]), Spread<Lanes>(p[1]), Spread<Lanes>(p[2])};
  }

  [[nodiscard]] std::size_t Count() const { return m_faces.size(); }

  // The face of these that has p above or below itself, the first if there are several, or the one that comes nearest
  // to that: FindFacePoint of it, and the least of its weights.
  FacePoint<Real> FindMostAbove(Real& leastWeight) const;
  // Squared distances of p from the faces and from their boxes, m².
  void FindSquares(OfEachFace<Real>& fromFaces, OfEachFace<Real>& fromBoxes) const;

 private:
  using Lanes = typename RowsOf<Real>::Lanes;
  struct Vectors {  // one of each face
    Lanes x, y, z;

    Vectors operator-(const Vectors& other) const { return {x - other.x, y - other.y, z - other.z}; }
    Vectors operator*(Lanes factor) const { return {factor * x, factor * y, factor * z}; }
    [[nodiscard]] Vectors Cross(const Vectors& other) const {
      return {y * other.z - z * other.y, z * other.x - x * other.z, x * other.y - y * other.x};
    }
    // Eigen adds in this order: of doubles, two fill a register.
    [[nodiscard]] Lanes Dot(const Vectors& other) const {
      const Lanes first = x * other.x;
      const Lanes second = y * other.y;
      const Lanes third = z * other.z;
      if constexpr (sizeof(Real) == sizeof(double)) return first + second + third;
      return first + (second + third);
    }
    [[nodiscard]] Lanes Square() const { return Dot(*this); }
  };

  static Vectors ReadCorners(const Skin<Real>& skin, const std::array<const Face*, kFacesAtOnce<Real>>& faces,
                             std::size_t corner) {
    const auto from = [&](std::size_t i) { return skin.x[(*faces[i])[corner]].data(); };
    Lanes rows[4];
    for (std::size_t i = 0; i < 4; ++i) rows[i] = LoadThrees(from(i), from((i + 4) % kFacesAtOnce<Real>));
    Transpose(rows);
    return {rows[0], rows[1], rows[2]};
  }
  [[nodiscard]] Lanes FindSquaresFromFaces() const;
  template <class Mask>
  static Lanes Choose(Mask mask, Lanes where, Lanes elsewhere) {
    return mask ? where : elsewhere;
  }
  static Lanes FindBeyond(Lanes a, Lanes b, Lanes c, Lanes p) {
    return Max(Spread<Lanes>(Real(0)), Max(Min(a, Min(b, c)) - p, p - Max(a, Max(b, c))));
  }

  Real m_side;
  Real m_offset;
  std::span<const std::uint16_t> m_faces;
  Vectors m_a, m_b, m_c, m_p;
};

// FindFacePoint, in lanes.
template <class Real>
FacePoint<Real> FaceRing<Real>::FindMostAbove(Real& leastWeight) const {
  const Vectors ab = m_b - m_a;
  const Vectors ac = m_c - m_a;
  const Vectors ap = m_p - m_a;
  const Vectors area = ab.Cross(ac);
  const Lanes doubleArea = Max(Sqrt(area.Square()), Spread<Lanes>(std::numeric_limits<Real>::min()));
  const Vectors upward{area.x / doubleArea, area.y / doubleArea, area.z / doubleArea};
  const Vectors normal = upward * Spread<Lanes>(m_side);
  const Lanes second = ap.Cross(ac).Dot(upward) / doubleArea;
  const Lanes third = ab.Cross(ap).Dot(upward) / doubleArea;
  const Lanes first = Spread<Lanes>(Real(1)) - second - third;
  enum : std::size_t { kLeast, kNormal, kWeights = kNormal + 3, kDistance = kWeights + 3, kDoubleArea, kNumbers };
  const Lanes results[kNumbers] = {
      Min(first, Min(second, third)),           normal.x,  normal.y, normal.z, first, second, third,
      ap.Dot(normal) - Spread<Lanes>(m_offset), doubleArea};
  OfEachFace<Real> numbers[kNumbers];
  for (std::size_t i = 0; i < kNumbers; ++i) StoreLanes(results[i], numbers[i].data());
  std::size_t best = 0;
  for (std::size_t i = 1; i < Count() && numbers[kLeast][best] < Real(0); ++i) {
    if (numbers[kLeast][i] > numbers[kLeast][best]) best = i;
  }
  const auto read = [&](std::size_t at) {
    return Vector3<Real>(numbers[at][best], numbers[at + 1][best], numbers[at + 2][best]);
  };
  leastWeight = numbers[kLeast][best];
  return {.face = m_faces[best],
          .distance = numbers[kDistance][best],
          .normal = read(kNormal),
          .weights = read(kWeights),
          .doubleArea = numbers[kDoubleArea][best]};
}

// FindSquaredDistance of face_search.cpp, in lanes: all regions are computed, and the first that p is in counts.
template <class Real>
typename FaceRing<Real>::Lanes FaceRing<Real>::FindSquaresFromFaces() const {
  const Lanes zero = Spread<Lanes>(Real(0));
  const Vectors ab = m_b - m_a;
  const Vectors ac = m_c - m_a;
  const Vectors ap = m_p - m_a;
  const Vectors bp = m_p - m_b;
  const Vectors cp = m_p - m_c;
  const Lanes d1 = ab.Dot(ap);
  const Lanes d2 = ac.Dot(ap);
  const Lanes d3 = ab.Dot(bp);
  const Lanes d4 = ac.Dot(bp);
  const Lanes d5 = ab.Dot(cp);
  const Lanes d6 = ac.Dot(cp);
  const Lanes va = d3 * d6 - d5 * d4;
  const Lanes vb = d5 * d2 - d1 * d6;
  const Lanes vc = d1 * d4 - d3 * d2;
  const Lanes toB = d4 - d3;
  const Lanes toC = d5 - d6;
  const Vectors normal = ab.Cross(ac);
  const Lanes height = normal.Dot(ap);
  const Lanes area = normal.Square();
  const Lanes apart = ap.Square();
  Lanes square = Choose(area > zero, height * height / area, apart);
  const Lanes fromBc = (bp - (m_c - m_b) * (toB / (toB + toC))).Square();
  square = Choose((va <= zero) & (toB >= zero) & (toC >= zero), fromBc, square);
  square = Choose((vb <= zero) & (d2 >= zero) & (d6 <= zero), (ap - ac * (d2 / (d2 - d6))).Square(), square);
  square = Choose((d6 >= zero) & (d5 <= d6), cp.Square(), square);
  square = Choose((vc <= zero) & (d1 >= zero) & (d3 <= zero), (ap - ab * (d1 / (d1 - d3))).Square(), square);
  square = Choose((d3 >= zero) & (d4 <= d3), bp.Square(), square);
  return Choose((d1 <= zero) & (d2 <= zero), apart, square);
}

template <class Real>
void FaceRing<Real>::FindSquares(OfEachFace<Real>& fromFaces, OfEachFace<Real>& fromBoxes) const {
  const Lanes x = FindBeyond(m_a.x, m_b.x, m_c.x, m_p.x);
  const Lanes y = FindBeyond(m_a.y, m_b.y, m_c.y, m_p.y);
  const Lanes z = FindBeyond(m_a.z, m_b.z, m_c.z, m_p.z);
  StoreLanes(x * x + y * y + z * z, fromBoxes.data());
  StoreLanes(FindSquaresFromFaces(), fromFaces.data());
}

}  // namespace wobble::physics
