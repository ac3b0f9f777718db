#include "server/recording/verify.h"

#include <fmt/format.h>

#include <span>

namespace wobble::recording {
namespace {

std::string Describe(const Difference& difference, const Recording& recording) {
  const std::string body =
      difference.body ? fmt::format("body {}", *difference.body) : std::string("a body whose number is not known");
  const double time = recording.TimeOf(difference.tick);
  return fmt::format("different in second {}, from tick {} on: {}", static_cast<int>(time), difference.tick, body);
}

}  // namespace

Proof Verify(const std::filesystem::path& path, const GroundSettings& settings, const Progress& progress) {
  Recording recording;
  std::string error = recording.Open(path);
  std::unique_ptr<server::Playground> ground;
  if (error.empty()) ground = MakeGround(recording.ReadHead(), settings, error);
  if (ground == nullptr) return {Verdict::kUnreadable, path.string() + " " + error};
  Replay replay(recording, *ground);
  error = replay.Seek(recording.FirstTick());
  if (!error.empty()) return {Verdict::kUnreadable, path.string() + ": " + error};

  const std::uint32_t tickHz = recording.ReadHead().tickHz;
  auto keyframe = recording.Keyframes().begin();
  std::optional<std::uint32_t> differentKeyframe;
  bool isStopped = false;
  while (replay.Advance()) {
    const std::uint32_t tick = replay.Tick();
    isStopped = tick % tickHz == 0 && !progress(recording.TimeOf(tick), recording.TimeOf(recording.LastTick()));
    if (isStopped) break;
    while (keyframe != recording.Keyframes().end() && keyframe->tick < tick) ++keyframe;
    const bool isKeyframe = keyframe != recording.Keyframes().end() && keyframe->tick == tick;
    if (isKeyframe && !replay.Matches(*keyframe)) differentKeyframe = tick;
    // A second more, to find the body.
    const auto& difference = replay.FirstDifference();
    if (differentKeyframe || (difference && (difference->body || tick > difference->tick + tickHz))) break;
  }
  Proof proof;
  if (const auto& difference = replay.FirstDifference()) {
    proof = {Verdict::kDifferent, Describe(*difference, recording)};
  } else if (differentKeyframe) {
    proof = {Verdict::kDifferent, fmt::format("different in the keyframe of tick {}", *differentKeyframe)};
  } else if (replay.Tick() < recording.LastTick()) {
    const double time = recording.TimeOf(replay.Tick());
    const double end = recording.TimeOf(recording.LastTick());
    if (isStopped) {
      return {Verdict::kBrokenOff, fmt::format("broken off at {:.1f} s of {:.1f} s, identical so far", time, end)};
    }
    return {Verdict::kUnreadable,
            fmt::format("{}: cannot be read behind {:.1f} s: it has changed", path.string(), time)};
  } else {
    proof.words = fmt::format("identical: {} ticks, {:.1f} s of {}", replay.Tick() - recording.FirstTick(),
                              recording.TimeOf(replay.Tick()), recording.ReadHead().scene.name);
  }
  const Bytes state = ToBytes(ground->Capture());
  proof.wholeState = physics::HashBytes(std::as_bytes(std::span(state)), physics::kHashSeed);
  if (!recording.Fault().empty()) {
    proof.words +=
        fmt::format("\ndamaged behind {:.1f} s: {}", recording.TimeOf(recording.LastTick()), recording.Fault());
    if (proof.verdict == Verdict::kIdentical) proof.verdict = Verdict::kUnreadable;
  } else if (!recording.IsWhole()) {
    proof.words += "\nthe recording has no end: what wrote it was broken off";
  }
  return proof;
}

}  // namespace wobble::recording
