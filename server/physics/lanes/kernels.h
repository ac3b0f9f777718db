// The sweeps that this processor can run.
#pragma once

#include <span>

#include "server/physics/lanes/sweep.h"

namespace wobble::physics {

// Ascending by width, the first of one lane. widest: none wider than this. All give the same bits.
template <class Real>
[[nodiscard]] std::span<const SweepKernel<Real>> FindSweepKernels(int widest);
inline constexpr int kWidestPack = 16;

// Each compiled by itself, for its own instruction set; the argument only says for which precision.
[[nodiscard]] SweepKernel<float> MakeOneLaneKernel(float precision);
[[nodiscard]] SweepKernel<double> MakeOneLaneKernel(double precision);
[[nodiscard]] SweepKernel<float> MakeAvx2Kernel(float precision);
[[nodiscard]] SweepKernel<double> MakeAvx2Kernel(double precision);
[[nodiscard]] SweepKernel<float> MakeAvx512Kernel(float precision);
[[nodiscard]] SweepKernel<double> MakeAvx512Kernel(double precision);

}  // namespace wobble::physics
