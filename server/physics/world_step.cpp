// One tick, phase by phase: prepare (what acts on each body, contacts with obstacles), search (pairs of bodies near one
// another and their contacts), wake (sleeping bodies that awake ones touch), islands (bodies that touch one another),
// step (each island by itself), finish (health, tearing, origin, sleep).
//
// Every phase runs in parallel over things that do not see each other: bodies, pairs, islands. One thread works on each
// from beginning to end and nothing is summed across threads, so the result cannot depend on how many there are. An
// island too large for one thread is stepped by all, body by body.
#include "server/physics/pair_search.h"
#include "server/physics/world_engine.h"
#include "server/physics/world_finish.h"
#include "server/physics/world_islands.h"
#include "server/physics/world_prepare.h"

namespace wobble::physics {

template <class Real>
StepReport World::StepIn(Workspace<Real>& work) {
  const double duration = m_settings.tickDuration;
  const StepRules rules{.duration = duration,
                        .allowedError = duration * m_settings.errorTarget,
                        .maxSubsteps = m_settings.maxSubsteps,
                        .leastSubsteps = m_settings.leastSubsteps};
  const Surroundings surroundings{.settings = m_settings,
                                  .obstacles = m_obstacles,
                                  .drives = m_drives,
                                  .stepForces = m_stepForces,
                                  .tick = m_tick,
                                  .time = (m_tick - 1.0) * duration};
  const std::span<const SweepKernel<Real>> kernels = FindSweepKernels<Real>(m_settings.widestPack);
  Threads& threads = m_engine->threads;
  Roster& roster = m_engine->roster;
  PairSearch<Real> search({m_bodies, m_blueprints, roster}, duration, kernels.back(), threads, work);
  const auto prepareAll = [&](std::span<const std::uint32_t> places) {
    threads.ForEach(places.size(), [&](std::size_t i) {
      const std::uint32_t place = places[i];
      Body& body = m_bodies[place];
      PrepareMember<Real>(surroundings, BlueprintOf(body), FindStiffnessRule(m_settings, m_slots[body.blueprint]), body,
                          work.scratch.local().prepare, work.members[place]);
      work.boxes[place] = FindTickBox(work.members[place], duration);
    });
  };
  const auto finish = [&](std::uint32_t island, const IslandOutcome& steps) {
    FinishIsland<Real>(surroundings, m_slots, rules.allowedError, island, steps, m_bodies, work);
  };

  work.Resize(m_bodies.size());
  prepareAll(roster.FindAwake());
  search.FindPairs();
  search.MeetAll();
  while (search.WakeTouched()) {
    prepareAll(work.pairs.woken);
    search.MeetAll();
  }
  search.DropPairsApart();
  search.PullApart();

  // Exactly the bodies that are awake from here on are stepped.
  const std::span<const std::uint32_t> awake = roster.FindAwake();
  std::vector<std::uint32_t>& stepped = m_engine->stepped;
  stepped.assign(awake.begin(), awake.end());
  FindAwakeIslands<Real>(stepped, m_bodies, work.members, work.pairs, work.islands);
  MakeBatches<Real>(rules, kernels.back().width, m_settings.threads, threads, work);
  StepBatches<Real>(rules, kernels, threads, work, finish);

  LetFallAsleep<Real>(duration, m_bodies, roster, search, work);
  return MakeReport(stepped, m_bodies, work.outcomes);
}

StepReport World::Step() {
  ++m_tick;
  WakeTheDriven();
  m_engine->gravity = m_settings.gravity;
  const StepReport report = std::visit([this](auto& work) { return StepIn(work); }, m_engine->workspace);
  m_stepForces.clear();
  RebuildTorn();
  return report;
}

}  // namespace wobble::physics
