#include "server/physics/methods/unwinding.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

// An edge shorter than this share of the mean is pushed as one of this length.
constexpr double kLeastEdgeShare = 0.25;

// Twice the area between two edges in the plane, positive where the second points to the left of the first.
template <class Real>
Real Cross(const Vector3<Real>& a, const Vector3<Real>& b) {
  return a.x() * b.z() - b.x() * a.z();
}

template <class Real>
Vector3<Real> EdgeAt(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x,
                     std::size_t edge) {
  return x[outline[edge][1]] - x[outline[edge][0]];
}

}  // namespace

template <class Real>
int FindTurningNumber(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x) {
  // The direction passes that of +x as often as it goes round, counted with its sign.
  int turns = 0;
  Vector3<Real> before = EdgeAt(outline, x, outline.size() - 1);
  for (std::size_t edge = 0; edge < outline.size(); ++edge) {
    const Vector3<Real> along = EdgeAt(outline, x, edge);
    const bool wasUp = before.z() >= Real(0);
    const bool isUp = along.z() >= Real(0);
    if (wasUp != isUp) {
      const bool turnsLeft = Cross<Real>(before, along) > Real(0);
      if (isUp && turnsLeft) ++turns;
      if (wasUp && !turnsLeft) --turns;
    }
    before = along;
  }
  return turns;
}

template <class Real>
std::array<VertexForce<Real>, 3> FindUnwinding(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  const std::span<const std::array<std::uint16_t, 2>> outline = body.outline;
  std::size_t sharpest = 0;  // the edge that begins at the sharpest corner
  Real least = 2;            // of cosines, those of corners to the left alone
  Real perimeter = 0;
  Vector3<Real> before = EdgeAt(outline, x, outline.size() - 1);
  for (std::size_t edge = 0; edge < outline.size(); ++edge) {
    const Vector3<Real> along = EdgeAt(outline, x, edge);
    const Real length = std::sqrt(along.dot(along));
    perimeter += length;
    const Real product = std::sqrt(before.dot(before)) * length;
    if (product > Real(0) && Cross<Real>(before, along) > Real(0) && before.dot(along) < least * product) {
      least = before.dot(along) / product;
      sharpest = edge;
    }
    before = along;
  }
  const std::size_t last = (sharpest + outline.size() - 1) % outline.size();
  const auto count = static_cast<Real>(outline.size());
  const Real floor = static_cast<Real>(kLeastEdgeShare) * perimeter / count;
  const Vector3<Real> out = EdgeAt(outline, x, sharpest);
  const Vector3<Real> in = EdgeAt(outline, x, last);
  // Half the torque with which the tension of a ring, 2 nRT over its perimeter, holds one of its edges by the end. With
  // half as much and with four times as much as many rings come back.
  Real torque = body.gas / count;
  const Real outSquare = out.dot(out);
  const Real inSquare = in.dot(in);
  torque *= std::min({Real(1), std::sqrt(outSquare) / floor, std::sqrt(inSquare) / floor});
  const auto pushAcross = [torque](const Vector3<Real>& edge, Real square) -> Vector3<Real> {
    if (!(square > Real(0))) return Vector3<Real>::Zero();
    return torque / square * Vector3<Real>(-edge.z(), 0, edge.x());
  };
  const Vector3<Real> onNext = pushAcross(out, outSquare);
  const Vector3<Real> onLast = pushAcross(in, inSquare);
  return {{{outline[sharpest][1], onNext}, {outline[last][0], onLast}, {outline[sharpest][0], -onNext - onLast}}};
}

#define WOBBLE_INSTANTIATE(Real)                                                                                       \
  template int FindTurningNumber<Real>(std::span<const std::array<std::uint16_t, 2>>, std::span<const Vector3<Real>>); \
  template std::array<VertexForce<Real>, 3> FindUnwinding<Real>(const Coefficients<Real>& body,                        \
                                                                std::span<const Vector3<Real>> x);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
