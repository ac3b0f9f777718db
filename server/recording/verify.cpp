#include "server/recording/verify.h"

#include <fmt/format.h>

namespace wobble::recording {
namespace {

std::string Describe(const Difference& difference, std::uint32_t tickHz) {
  const std::string body =
      difference.body ? fmt::format("body {}", *difference.body) : std::string("a body whose number is not known");
  return fmt::format("different from tick {} on, in second {} (at {} ticks a second): {}", difference.tick,
                     static_cast<int>(difference.second), tickHz, body);
}

}  // namespace

Proof Verify(const std::filesystem::path& path, const ReplaySettings& settings,
             const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t)>& progress) {
  std::string error;
  const auto replay = Replay::Open(path, settings, error);
  if (replay == nullptr) return {Verdict::kUnreadable, path.string() + " " + error};
  const std::uint32_t tickHz = replay->ReadHead().tickHz;
  const physics::World& world = replay->Ground().World();
  auto keyframe = replay->Keyframes().begin();
  std::optional<std::uint32_t> differentKeyframe;
  while (replay->Advance()) {
    if (world.Tick() % tickHz == 0 && !progress(world.Tick(), replay->FirstTick(), replay->LastTick())) break;
    while (keyframe != replay->Keyframes().end() && keyframe->tick < world.Tick()) ++keyframe;
    const bool isKeyframe = keyframe != replay->Keyframes().end() && keyframe->tick == world.Tick();
    if (isKeyframe && !replay->Matches(*keyframe)) differentKeyframe = world.Tick();
    // A second more, to find the body.
    const auto& difference = replay->FirstDifference();
    if (differentKeyframe || (difference && (difference->body || world.Tick() > difference->tick + tickHz))) break;
  }
  Proof proof;
  const auto& difference = replay->FirstDifference();
  const double played = double{1} * (world.Tick() - replay->FirstTick()) / tickHz;
  if (difference || differentKeyframe) {
    proof.verdict = Verdict::kDifferent;
    proof.words = difference ? Describe(*difference, tickHz)
                             : fmt::format("different in the keyframe of tick {}", *differentKeyframe);
  } else {
    proof.words = fmt::format("identical: {} ticks, {:.1f} s of {}, {} keyframes", world.Tick() - replay->FirstTick(),
                              played, replay->ReadHead().scene.name, replay->Keyframes().size());
  }
  if (!replay->Fault().empty()) {
    proof.words += fmt::format("\ndamaged behind {:.1f} s: {}", replay->Duration(), replay->Fault());
    if (proof.verdict == Verdict::kIdentical) proof.verdict = Verdict::kUnreadable;
  } else if (!replay->IsWhole()) {
    proof.words += "\nthe recording ends without an end: what wrote it was broken off";
  }
  return proof;
}

}  // namespace wobble::recording
