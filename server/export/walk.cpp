#include "server/export/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace wobble::exporting {
namespace {

Frame MakeFrame(const server::Playground& ground, const WalkSettings& settings, double time) {
  Frame frame{.time = time, .tick = ground.World().Tick(), .ground = ground, .bodies = {}};
  for (const physics::Body& body : ground.World().Bodies()) {
    const bool isWanted =
        settings.bodies.empty() || std::ranges::find(settings.bodies, body.id) != settings.bodies.end();
    if (isWanted) frame.bodies.push_back(&body);
  }
  return frame;
}

std::string NameMissing(const WalkSettings& settings, const std::set<physics::BodyId>& seen,
                        const physics::World& world) {
  std::vector<physics::BodyId> missing;
  for (const physics::BodyId id : settings.bodies) {
    if (!seen.contains(id)) missing.push_back(id);
  }
  if (missing.empty()) return {};
  std::vector<physics::BodyId> there;
  for (const physics::Body& body : world.Bodies()) there.push_back(body.id);
  return fmt::format("--bodies {}: there is no such body in these frames; at their end there are {}",
                     fmt::join(missing, ","), there.empty() ? "none" : fmt::format("{}", fmt::join(there, ",")));
}

}  // namespace

std::uint32_t Plan::TickOf(std::uint32_t frame) const {
  return firstTick + static_cast<std::uint32_t>(std::llround(frame * ticksPerFrame));
}

std::optional<Plan> MakePlan(const recording::Recording& recording, const WalkSettings& settings, std::string& error) {
  const double tickHz = recording.ReadHead().tickHz;
  const double end = recording.TimeOf(recording.LastTick());
  const double to = settings.to > 0 ? settings.to : end;
  // As near to the end as the ticks are to one another, since people read times off a rounded display.
  const double least = 0.5 / tickHz;
  if (settings.from > end + least) {
    error = fmt::format("--from {}: must be 0 to {:.3f}, the seconds of the recording", settings.from, end);
  } else if (to > end + least || to < settings.from) {
    error = fmt::format("--to {}: must be {} to {:.3f}, from --from to the recording's end", to, settings.from, end);
  } else if (!(settings.fps > 0 && settings.fps <= tickHz)) {
    error = fmt::format("--fps {}: must be more than 0 and at most {}, the recording's ticks a second", settings.fps,
                        tickHz);
  }
  if (!error.empty()) return {};
  const auto tickAt = [&](double time) {
    const auto ticks = static_cast<std::uint32_t>(std::llround(time * tickHz));
    return std::min(recording.FirstTick() + ticks, recording.LastTick());
  };
  Plan plan{.firstTick = tickAt(settings.from), .frames = 1, .ticksPerFrame = tickHz / settings.fps};
  const std::uint32_t ticks = tickAt(to) - plan.firstTick;
  plan.frames += static_cast<std::uint32_t>(ticks / plan.ticksPerFrame);
  while (plan.TickOf(plan.frames - 1) > tickAt(to)) --plan.frames;
  return plan;
}

Walked Walk(recording::Recording& recording, recording::Replay& replay, const server::Playground& ground,
            const WalkSettings& settings, const Plan& plan, FrameWriter& writer, const recording::Progress& progress) {
  Walked walked;
  std::set<physics::BodyId> seen;
  // A tick early where there is one: a state from a keyframe has no forces of the tick that led to it.
  const std::uint32_t before = plan.firstTick > recording.FirstTick() ? plan.firstTick - 1 : plan.firstTick;
  walked.error = replay.Seek(before);
  const double end = recording.TimeOf(plan.TickOf(plan.frames - 1));
  while (walked.error.empty() && walked.frames < plan.frames && !walked.isStopped) {
    const std::uint32_t tick = plan.TickOf(walked.frames);
    while (replay.Tick() < tick && replay.Advance()) {
    }
    if (replay.Tick() != tick) {
      walked.error = fmt::format("tick {}: cannot be read", tick);
      break;
    }
    const Frame frame = MakeFrame(ground, settings, recording.TimeOf(tick));
    for (const physics::Body* body : frame.bodies) seen.insert(body->id);
    walked.error = writer.Add(frame);
    walked.lastTime = frame.time;
    ++walked.frames;
    walked.isStopped = !progress(frame.time, end) && walked.frames < plan.frames;
  }
  walked.bodies = seen.size();
  if (walked.isStopped) return walked;
  if (walked.error.empty()) walked.error = NameMissing(settings, seen, ground.World());
  if (walked.error.empty()) walked.error = writer.Finish();
  return walked;
}

}  // namespace wobble::exporting
