// The engine's own sweep, compiled with the properties of a blueprint as constants, so that the compiler removes the
// checks for them. Callgrind counts the functions named SweepBare.
#include "tests/bench/terms/bare.h"

#include <initializer_list>

#include "server/physics/kernels/sweep_kernel.h"

namespace wobble::bench {
namespace {

using namespace physics;

using Lanes = LanesOf<float, 8>::Type;

template <int Stage, bool Gas>
__attribute__((noinline, flatten)) void SweepBare(const SweepTables<float>& tables, SweepLanes<float>& lanes,
                                                  float step) {
  SweepTables<float> bare = tables;
  bare.hasGas = Gas;
  bare.planar = false;
  lanes.outer = nullptr;
  SweepStage<Stage, Lanes, float>(bare, lanes, step);
}

template <int Stage>
__attribute__((noinline, flatten)) void SweepBareGrid(const GridTables<float>& tables, SweepLanes<float>& lanes,
                                                      float step) {
  GridTables<float> bare = tables;
  bare.hasDrag = false;
  bare.planar = false;
  lanes.outer = nullptr;
  SweepGrid<Stage, Lanes, float>(bare, lanes, step);
}

template <bool Gas>
SweepKernel<float> Make() {
  SweepKernel<float> kernel = MakeKernel<float, 8>();
  kernel.stages[0] = &SweepBare<0, Gas>;
  kernel.stages[1] = &SweepBare<1, Gas>;
  kernel.stages[2] = &SweepBare<2, Gas>;
  kernel.stages[3] = &SweepBare<3, Gas>;
  kernel.gridStages[0] = &SweepBareGrid<0>;
  kernel.gridStages[1] = &SweepBareGrid<1>;
  kernel.gridStages[2] = &SweepBareGrid<2>;
  kernel.gridStages[3] = &SweepBareGrid<3>;
  return kernel;
}

}  // namespace

SweepKernel<float> MakeBareKernel(bool hasGas) { return hasGas ? Make<true>() : Make<false>(); }

}  // namespace wobble::bench
