#include "server/export/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace wobble::exporting {
namespace {

// How far a time may be beyond the end, s: people read it off displays that round to a tenth.
constexpr double kRounding = 0.05;

Frame MakeFrame(const server::Playground& ground, const WalkSettings& settings, double time) {
  Frame frame{.time = time, .tick = ground.World().Tick(), .ground = ground, .bodies = {}};
  for (const physics::Body& body : ground.World().Bodies()) {
    const bool isWanted =
        settings.bodies.empty() || std::ranges::find(settings.bodies, body.id) != settings.bodies.end();
    if (isWanted) frame.bodies.push_back(&body);
  }
  return frame;
}

// there: in any frame.
std::string NameMissing(const WalkSettings& settings, const std::set<physics::BodyId>& there) {
  std::vector<physics::BodyId> missing;
  for (const physics::BodyId id : settings.bodies) {
    if (!there.contains(id)) missing.push_back(id);
  }
  if (missing.empty()) return {};
  return fmt::format("--bodies {}: there is no such body in these frames, which have {}", fmt::join(missing, ","),
                     there.empty() ? "none" : fmt::format("{}", fmt::join(there, ",")));
}

}  // namespace

std::uint32_t Plan::TickOf(std::uint32_t frame) const {
  return firstTick + static_cast<std::uint32_t>(std::llround(frame * ticksPerFrame));
}

std::optional<Plan> MakePlan(const recording::Recording& recording, const WalkSettings& settings, std::string& error) {
  const double tickHz = recording.ReadHead().tickHz;
  const double end = recording.TimeOf(recording.LastTick());
  const double to = std::isinf(settings.to) ? end : settings.to;
  if (!(settings.from >= 0 && settings.from <= end + kRounding)) {
    error = fmt::format("--from {}: must be 0 to {:.3f}, the seconds of the recording", settings.from, end);
  } else if (!(to <= end + kRounding && (to >= settings.from || std::isinf(settings.to)))) {
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
  std::set<physics::BodyId> there, chosen;
  // A tick early where there is one: a state from a keyframe has no forces of the tick that led to it.
  const std::uint32_t before = plan.firstTick > recording.FirstTick() ? plan.firstTick - 1 : plan.firstTick;
  walked.error = replay.Seek(before);
  const double end = recording.TimeOf(plan.TickOf(plan.frames - 1));
  const auto isGood = [&] { return walked.error.empty() && walked.outputError.empty(); };
  while (isGood() && walked.frames < plan.frames && !walked.isStopped) {
    const std::uint32_t tick = plan.TickOf(walked.frames);
    while (replay.Tick() < tick && replay.Advance()) {
    }
    if (replay.Tick() != tick) {
      walked.error = fmt::format("tick {}: cannot be read", tick);
      break;
    }
    const Frame frame = MakeFrame(ground, settings, recording.TimeOf(tick));
    for (const physics::Body& body : ground.World().Bodies()) there.insert(body.id);
    for (const physics::Body* body : frame.bodies) chosen.insert(body->id);
    walked.outputError = writer.Add(frame);
    walked.lastTime = frame.time;
    ++walked.frames;
    walked.isStopped = !progress(frame.time, end) && walked.frames < plan.frames;
  }
  walked.bodies = chosen.size();
  if (walked.isStopped) return walked;
  if (isGood()) walked.error = NameMissing(settings, there);
  if (isGood()) walked.outputError = writer.Finish();
  return walked;
}

}  // namespace wobble::exporting
