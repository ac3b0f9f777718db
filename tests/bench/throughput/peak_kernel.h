// The chains of fused multiply-adds, for the translation units that compile them for one instruction set each.
//
// A fused multiply-add takes four cycles and a core starts one or two per cycle: eight independent chains keep it busy;
// twelve leave room for the rest of the loop and fit the sixteen registers of AVX2.
#pragma once

#include "server/physics/lanes/lanes.h"

namespace wobble::bench {

inline constexpr int kChains = 12;
inline constexpr int kLinks = 20000;

namespace {

template <int W>
float RunChains() {
  using V = typename physics::LanesOf<float, W>::Type;
  const V factor = physics::Spread<V>(0.999F);
  const V added = physics::Spread<V>(0.001F);
  V chains[kChains];
  for (int i = 0; i < kChains; ++i) chains[i] = physics::Spread<V>(static_cast<float>(i));
  for (int link = 0; link < kLinks; ++link) {
    for (V& chain : chains) chain = physics::Fma(chain, factor, added);
  }
  V sum = chains[0];
  for (int i = 1; i < kChains; ++i) sum = sum + chains[i];
  float lanes = 0;
  for (int i = 0; i < W; ++i) lanes += reinterpret_cast<const float*>(&sum)[i];
  return lanes;
}

}  // namespace
}  // namespace wobble::bench
