// A tick is quiet when the body hardly moved in it and its player asks for nothing: held input keeps a body awake even
// where it cannot move, so that no request is lost in sleep.
#include "server/physics/step/sleep.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

// Gas and stiffness factors approach their aim exponentially; this near to it they count as arrived.
constexpr double kFactorPlay = 1e-3;

}  // namespace

bool IsLeftAlone(const Body& body, double restingStiffness) {
  return body.control == Control{} && std::fabs(body.gasFactor - 1) < kFactorPlay &&
         std::fabs(body.stiffnessFactor - restingStiffness) < kFactorPlay;
}

template <class Real>
void NoteMotion(const Member<Real>& member, double restingStiffness, Body& body) {
  const bool quiet = member.speed < kQuietSpeed && IsLeftAlone(body, restingStiffness);
  body.quietTicks = quiet ? body.quietTicks + 1 : 0;
}

void FindQuietIslands(double tickDuration, const Islands& islands, std::span<const Body> bodies,
                      std::vector<std::uint32_t>& places) {
  const int patience = static_cast<int>(kQuietTime / tickDuration);
  const auto isQuiet = [&](std::uint32_t place) { return bodies[place].quietTicks >= patience; };
  places.clear();
  for (std::uint32_t island = 0; island < islands.Count(); ++island) {
    const std::span<const std::uint32_t> members = islands.MembersOf(island);
    if (std::all_of(members.begin(), members.end(), isQuiet)) {
      places.insert(places.end(), members.begin(), members.end());
    }
  }
  std::sort(places.begin(), places.end());
}

template <class Real>
void FallAsleep(Body& body, State<Real>& state) {
  body.asleep = true;
  for (Vector3<Real>& v : state.velocities) v.setZero();
}

template void NoteMotion<float>(const Member<float>&, double, Body&);
template void NoteMotion<double>(const Member<double>&, double, Body&);
template void FallAsleep<float>(Body&, State<float>&);
template void FallAsleep<double>(Body&, State<double>&);

}  // namespace wobble::physics
