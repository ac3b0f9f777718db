// Differs from the plain step (island_step.cpp) only in how a try is integrated; both ask IslandTick what to do next.
// Only the first try is shared by the whole batch: the few islands that have to be stepped again, each with its own
// number of substeps, get packs of their own.
#include "server/physics/packs/batch_step.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "server/physics/step/island_tick.h"

namespace wobble::physics {
namespace {

// Integrates one try of a tick for all members of a system, in packs.
template <class Real>
class LaneStepping {
 public:
  LaneStepping(const BodySystem<Real>& system, std::span<const SweepKernel<Real>> kernels, BatchScratch<Real>& scratch)
      : m_system(system), m_packs(scratch.packs) {
    FillPacks(kernels, scratch);
  }

  // Integrates through `duration` s. Results: positions and velocities in the system's arrays, errors,
  // Member::insideOut and contacts in the members.
  void Integrate(double duration, int substeps) {
    for (Member<Real>* member : m_system.Members()) member->error = 0;
    if (m_system.ContactPairs().empty()) {
      ForEachPack([&](auto& pack) { IntegrateAlone(pack, duration, substeps); });
    } else {
      IntegrateTogether(duration, substeps);
    }
    ForEachPack([](const auto& pack) { pack.EndTry(); });
    for (Member<Real>* member : m_system.Members()) member->error *= kErrorShare / substeps;
  }

 private:
  void FillPacks(std::span<const SweepKernel<Real>> kernels, BatchScratch<Real>& scratch) {
    const auto blueprintOf = [this](std::uint32_t i) { return m_system.Members()[i]->blueprint; };
    const auto isCut = [this](std::uint32_t i) { return IsCut(*m_system.Members()[i]); };
    const auto comesBefore = [&](std::uint32_t a, std::uint32_t b) {
      if (blueprintOf(a) != blueprintOf(b)) return std::less<>()(blueprintOf(a), blueprintOf(b));
      return isCut(a) != isCut(b) ? isCut(b) : a < b;
    };
    scratch.order.resize(m_system.CountBodies());
    std::iota(scratch.order.begin(), scratch.order.end(), 0U);
    std::sort(scratch.order.begin(), scratch.order.end(), comesBefore);
    const std::span<const std::uint32_t> order(scratch.order);
    m_packs.clear();
    for (std::size_t begin = 0; begin < order.size();) {
      const Blueprint* blueprint = blueprintOf(order[begin]);
      const bool cut = isCut(order[begin]);
      std::size_t end = begin + 1;
      while (end < order.size() && blueprintOf(order[end]) == blueprint && isCut(order[end]) == cut) ++end;
      // A cut body has a rare term, so that it must go the same way however many are cut: as if it were alone.
      const bool byRows = GoesByRows<Real>(*blueprint, cut ? 1 : end - begin);
      const std::size_t size = byRows ? 1 : FindPackSize(end - begin, static_cast<std::size_t>(kernels.back().width));
      for (; begin < end; begin += std::min(size, end - begin)) {
        AddPack(byRows, order.subspan(begin, std::min(size, end - begin)), kernels, scratch);
      }
    }
  }

  void AddPack(bool byRows, std::span<const std::uint32_t> whose, std::span<const SweepKernel<Real>> kernels,
               BatchScratch<Real>& scratch) {
    if (scratch.packScratches.size() == m_packs.size()) scratch.packScratches.emplace_back();
    PackScratch<Real>& packScratch = scratch.packScratches[m_packs.size()];
    const PackBodies<Real> bodies{.system = m_system, .whose = whose};
    if (byRows) {
      m_packs.emplace_back(std::in_place_type<RowPack<Real>>, bodies, kernels, packScratch);
    } else {
      m_packs.emplace_back(std::in_place_type<LanePack<Real>>, bodies, kernels, packScratch);
    }
  }

  // How many of `count` alike bodies make a pack. Packs that threads share out are of one size, and as many for each
  // thread: a sweep takes as long however many of its lanes are filled, but forces and copies go body by body.
  [[nodiscard]] std::size_t FindPackSize(std::size_t count, std::size_t widest) const {
    const std::size_t threads = m_system.CountThreads();
    if (threads == 1 || count < 2 * threads) return widest;
    const std::size_t packs = (count + widest - 1) / widest;
    const std::size_t shared = (packs + threads - 1) / threads * threads;
    return (count + shared - 1) / shared;
  }

  // Calls visit(pack) once for each pack, on any thread.
  template <class Visit>
  void ForEachPack(const Visit& visit) {
    m_system.ForEach(m_packs.size(), [&](std::size_t i) { std::visit(visit, m_packs[i]); });
  }

  // A pack through all substeps in one go, while it is in the cache.
  template <class OnePack>
  static void IntegrateAlone(OnePack& pack, double duration, int substeps) {
    const double step = duration / substeps;
    for (int substep = 0; substep < substeps; ++substep) {
      for (int stage = 0; stage < 4; ++stage) {
        pack.BeginStage(stage);
        pack.Sweep(stage, static_cast<Real>(step));
      }
      pack.EndStep(step, duration - substep * step, substep == 0);
    }
  }

  // The system's points hold the positions and velocities that a stage is computed at, for the contacts between
  // members.
  void IntegrateTogether(double duration, int substeps) {
    const double step = duration / substeps;
    ForEachPack([](const auto& pack) { pack.CopyToPoints(0); });
    for (int substep = 0; substep < substeps; ++substep) {
      for (int stage = 0; stage < 4; ++stage) StepStage(stage, static_cast<Real>(step));
      ForEachPack([&](auto& pack) {
        pack.EndStep(step, duration - substep * step, substep == 0);
        pack.CopyToPoints(0);
      });
      m_system.UpdateAllBodyContacts(static_cast<Real>(step));
    }
  }

  // The positions of stage 0 are among the system's points already.
  void StepStage(int stage, Real h) {
    if (stage > 0) ForEachPack([&](const auto& pack) { pack.CopyToPoints(stage); });
    m_system.ComputeAllBodyContacts();
    ForEachPack([&](auto& pack) {
      pack.BeginStage(stage);
      const std::span<const std::uint32_t> whose = pack.Bodies().whose;
      for (std::size_t lane = 0; lane < whose.size(); ++lane) {
        pack.AddOuterForces(lane, [&](const auto& add) { m_system.VisitContactForces(whose[lane], add); });
      }
      pack.Sweep(stage, h);
    });
  }

  const BodySystem<Real>& m_system;
  std::vector<AnyPack<Real>>& m_packs;
};

// The tries of an island after the first.
template <class Real>
IslandOutcome StepAgain(const BodySystem<Real>& system, const Island& island, int substeps, const StepRules& rules,
                        IslandTick<Real>& tick, std::span<const SweepKernel<Real>> kernels, Threads* threads,
                        BatchScratch<Real>& scratch) {
  const auto contactPairs = system.ContactPairsOf(island);
  scratch.contactPairsAgain.assign(contactPairs.begin(), contactPairs.end());
  for (ContactPair<Real>& contactPair : scratch.contactPairsAgain) {
    for (std::uint32_t& member : contactPair.members) member -= static_cast<std::uint32_t>(island.memberBegin);
  }
  const BodySystem<Real> alone(system.MembersOf(island), scratch.contactPairsAgain, threads, kernels.back(),
                               scratch.again);
  for (; substeps > 0; substeps = tick.Judge(alone, alone.All(), substeps)) {
    LaneStepping<Real>(alone, kernels, scratch).Integrate(rules.duration, substeps);
  }
  return tick.Finish(alone, alone.All());
}

}  // namespace

template <class Real>
bool CanGoInPack(const Blueprint& blueprint) {
  return blueprint.full.contact.law != ContactLaw::kBacktracking && !blueprint.ReadPlan<Real>().vertices.empty();
}

template <class Real>
void BatchScratch<Real>::Reserve(std::size_t mostVertices, std::size_t allVertices, std::size_t bodies) {
  system.Reserve(allVertices, bodies);
  again.Reserve(allVertices, bodies);
  order.reserve(bodies);
  packs.reserve(bodies);
  if (packScratches.empty()) packScratches.emplace_back();
  for (PackScratch<Real>& each : packScratches) each.Reserve(mostVertices);
}

template <class Real>
void StepBatch(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
               std::span<const Island> islands, int substeps, const StepRules& rules,
               std::span<const SweepKernel<Real>> kernels, Threads* threads, BatchScratch<Real>& scratch,
               std::span<IslandOutcome> outcomes) {
  const BodySystem<Real> system(members, contactPairs, threads, kernels.back(), scratch.system);
  LaneStepping<Real>(system, kernels, scratch).Integrate(rules.duration, substeps);
  for (std::size_t i = 0; i < islands.size(); ++i) {
    IslandTick<Real> tick(system.MembersOf(islands[i]), rules);
    const int next = tick.Judge(system, islands[i], substeps);
    outcomes[i] = next == 0 ? tick.Finish(system, islands[i])
                            : StepAgain(system, islands[i], next, rules, tick, kernels, threads, scratch);
  }
}

template <class Real>
void IntegrateBatch(std::span<Member<Real>* const> members, double duration, int substeps,
                    std::span<const SweepKernel<Real>> kernels, BatchScratch<Real>& scratch) {
  const BodySystem<Real> system(members, {}, nullptr, kernels.back(), scratch.system);
  LaneStepping<Real>(system, kernels, scratch).Integrate(duration, substeps);
  system.Scatter(system.All());
}

#define WOBBLE_INSTANTIATE(Real)                                                                                      \
  template struct BatchScratch<Real>;                                                                                 \
  template bool CanGoInPack<Real>(const Blueprint&);                                                                  \
  template void StepBatch<Real>(std::span<Member<Real>* const>, std::span<const ContactPair<Real>>,                   \
                                std::span<const Island>, int, const StepRules&, std::span<const SweepKernel<Real>>,   \
                                Threads*, BatchScratch<Real>&, std::span<IslandOutcome>);                             \
  template void IntegrateBatch<Real>(std::span<Member<Real>* const>, double, int, std::span<const SweepKernel<Real>>, \
                                     BatchScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
