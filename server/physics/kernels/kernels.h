// The room physics/kernels holds the hot loops of the engine, compiled once for each instruction set. This file chooses
// those that the processor can run.
#pragma once

#include <span>

#include "server/physics/kernels/sweep.h"

namespace wobble::physics {

// The kernels of at most `widest` lanes, ascending by width; the first has one lane. All give the same bits.
template <class Real>
[[nodiscard]] std::span<const SweepKernel<Real>> FindSweepKernels(int widest);
inline constexpr int kWidestPack = 16;

// Of a body with elements, at positions x y z of each of its vertices.
[[nodiscard]] ElementStrain<float> FindElementStrain(const SweepTables<float>& tables, const float* positions);
[[nodiscard]] ElementStrain<double> FindElementStrain(const SweepTables<double>& tables, const double* positions);

// Each is compiled by itself for its own instruction set. The argument only chooses the precision.
[[nodiscard]] SweepKernel<float> MakeOneLaneKernel(float precision);
[[nodiscard]] SweepKernel<double> MakeOneLaneKernel(double precision);
[[nodiscard]] SweepKernel<float> MakeBaselineKernel(float precision);
[[nodiscard]] SweepKernel<double> MakeBaselineKernel(double precision);
[[nodiscard]] SweepKernel<float> MakeAvx512Kernel(float precision);
[[nodiscard]] SweepKernel<double> MakeAvx512Kernel(double precision);

}  // namespace wobble::physics
