// wobble_terms KIND engine|bare STEPS: steps eight bodies in the air while callgrind counts instructions. `engine`
// takes the normal path; `bare` replaces its sweep by one without the terms that these bodies lack.
//
// It is a separate program, because the other work of the laboratory would take longer under callgrind than the steps.
#include <array>
#include <charconv>
#include <cstdio>
#include <string_view>
#include <vector>

#include "server/physics/packs/batch_step.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/lattice.h"
#include "tests/bench/terms/bare.h"

namespace {

using namespace wobble;
using namespace wobble::physics;

constexpr std::size_t kBodies = 8;
constexpr double kStep = 1.0 / 240;  // s

Blueprint MakeKind(std::string_view kind) { return kind == "gas" ? MakeBall({}) : MakeLattice({}); }

void Step(const Blueprint& blueprint, std::span<const SweepKernel<float>> kernels, int steps) {
  std::vector<State<float>> states(kBodies, MakeState<float>(blueprint, Vector3d::Zero(), Vector3d::Zero()));
  std::vector<Member<float>> members(kBodies);
  std::vector<Member<float>*> pointers;
  for (std::size_t i = 0; i < kBodies; ++i) {
    members[i].blueprint = &blueprint;
    members[i].state = &states[i];
    members[i].load.acceleration = Vector3<float>(0, 0, -9.81F);
    pointers.push_back(&members[i]);
  }
  BatchScratch<float> scratch;
  IntegrateBatch<float>(pointers, steps * kStep, steps, kernels, scratch);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view words[] = {argc == 4 ? argv[1] : "", argc == 4 ? argv[2] : "", argc == 4 ? argv[3] : ""};
  int steps = 0;
  std::from_chars(words[2].data(), words[2].data() + words[2].size(), steps);
  if ((words[0] != "gas" && words[0] != "solid") || (words[1] != "engine" && words[1] != "bare") || steps < 1) {
    std::fprintf(stderr, "usage: wobble_terms gas|solid engine|bare STEPS\n");
    return 2;
  }
  const Blueprint blueprint = MakeKind(words[0]);
  const auto kernels = FindSweepKernels<float>(static_cast<int>(kBodies));
  std::array<SweepKernel<float>, 1> bare{bench::MakeBareKernel(words[0] == "gas")};
  Step(blueprint, words[1] == "bare" ? std::span<const SweepKernel<float>>(bare) : kernels, steps);
  return 0;
}
