// The elasticity and viscosity of tetrahedra (methods/elasticity.h). The sweep of rare terms has them; in a function
// that is not inlined, so that bodies without tetrahedra carry a call that is not made and nothing else. A lone solid
// has an element in each lane (lone_solid.h): Constants gives an element's numbers as vectors, in either case.
#pragma once

#include "server/physics/kernels/sweep.h"
#include "server/physics/kernels/terms.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

template <class V>
WOBBLE_INLINE V FindDot(const V* a, const V* b) {
  return Fma(a[2], b[2], Fma(a[1], b[1], a[0] * b[0]));
}

template <class V>
WOBBLE_INLINE void FindCross(const V* a, const V* b, V* cross) {
  cross[0] = Fms(a[1], b[2], a[2] * b[1]);
  cross[1] = Fms(a[2], b[0], a[0] * b[2]);
  cross[2] = Fms(a[0], b[1], a[1] * b[0]);
}

// The columns of Σ wᵢ gᵢᵀ, with wᵢ from the first corner to the others.
template <class V, class Constants>
WOBBLE_INLINE void FindGradient(const Constants& constants, const V (&ways)[3][3], V (&columns)[3][3]) {
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) {
      columns[c][k] = Fma(constants.Gradient(2, c), ways[2][k],
                          Fma(constants.Gradient(1, c), ways[1][k], constants.Gradient(0, c) * ways[0][k]));
    }
  }
}

// V P of the elastic energy, times the factor.
template <class Real, class V, class Constants>
WOBBLE_INLINE void FindElasticStress(const Constants& constants, Real restRatio, V factor, const V (&f)[3][3],
                                     V (&stress)[3][3]) {
  const V one = Spread<V>(Real(1));
  V cofactors[3][3];
  for (int c = 0; c < 3; ++c) FindCross(f[(c + 1) % 3], f[(c + 2) % 3], cofactors[c]);
  const V square = FindDot(f[0], f[0]) + FindDot(f[1], f[1]) + FindDot(f[2], f[2]);
  const V ofShape = factor * constants.Shear() * (one - one / (square + one));
  const V ofVolume = factor * constants.Bulk() * (FindDot(f[0], cofactors[0]) - Spread<V>(restRatio));
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) stress[c][k] = Fma(ofVolume, cofactors[c][k], ofShape * f[c][k]);
  }
}

// Adds V 2 η F Ė, times the factor.
template <class V, class Constants>
WOBBLE_INLINE void AddViscousStress(const Constants& constants, V factor, const V (&f)[3][3], const V (&rates)[3][3],
                                    V (&stress)[3][3]) {
  const V viscosity = factor * constants.Viscosity();
  for (int c = 0; c < 3; ++c) {
    for (int d = c; d < 3; ++d) {
      const V strainRate = viscosity * (FindDot(f[d], rates[c]) + FindDot(f[c], rates[d]));
      for (int k = 0; k < 3; ++k) stress[c][k] = Fma(strainRate, f[d][k], stress[c][k]);
      if (c == d) continue;
      for (int k = 0; k < 3; ++k) stress[d][k] = Fma(strainRate, f[c][k], stress[d][k]);
    }
  }
}

// V P gᵢ: the force with which the element pulls its first corner towards corner i, and corner i back.
template <class V, class Constants>
WOBBLE_INLINE void FindElementPulls(const Constants& constants, const V (&stress)[3][3], V (&pulls)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      pulls[i][k] = Fma(constants.Gradient(i, 2), stress[2][k],
                        Fma(constants.Gradient(i, 1), stress[1][k], constants.Gradient(i, 0) * stress[0][k]));
    }
  }
}

// One element for all lanes.
template <class V, class Real>
struct SpreadConstants {
  const Element<Real>& element;

  V Gradient(int i, int c) const { return Spread<V>(element.gradients[i][c]); }
  V Shear() const { return Spread<V>(element.shear); }
  V Bulk() const { return Spread<V>(element.bulk); }
  V Viscosity() const { return Spread<V>(element.viscosity); }
};

// number: 0 for positions, 3 for velocities.
template <class V, class Real>
WOBBLE_INLINE void LoadWays(const Element<Real>& element, const V* from, const V* own, int number, V (&ways)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    const V* other = from + element.others[i] + number;
    for (int k = 0; k < 3; ++k) ways[i][k] = other[k] - own[number + k];
  }
}

// Adds the forces of the elements from `element` up to `end`, whose first place is the sweep's.
template <class V, class Real>
__attribute__((noinline)) void AddElements(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes,
                                           const Element<Real>* element, const Element<Real>* end, const V* from,
                                           const V* own, V* pending, Vector3Of<V>& force) {
  const V factor = *reinterpret_cast<const V*>(lanes.stiffnessFactors);
  const Real restRatio = tables.restRatio;
  V sum[3] = {force.x, force.y, force.z};
  for (; element != end; ++element) {
    const SpreadConstants<V, Real> constants{*element};
    V ways[3][3];
    V f[3][3];
    V stress[3][3];
    LoadWays(*element, from, own, 0, ways);
    FindGradient(constants, ways, f);
    FindElasticStress(constants, restRatio, factor, f, stress);
    if (element->viscosity > Real(0)) {
      V rates[3][3];
      LoadWays(*element, from, own, 3, ways);
      FindGradient(constants, ways, rates);
      AddViscousStress(constants, factor, f, rates, stress);
    }
    V pulls[3][3];
    FindElementPulls(constants, stress, pulls);
    for (int i = 0; i < 3; ++i) {
      V* onOther = pending + element->pending[i];
      for (int k = 0; k < 3; ++k) {
        sum[k] = sum[k] + pulls[i][k];
        onOther[k] = onOther[k] - pulls[i][k];
      }
    }
  }
  force = {sum[0], sum[1], sum[2]};
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
