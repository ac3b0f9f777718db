#include "server/replaying.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "server/export/csv.h"
#include "server/export/output.h"
#include "server/export/vtk.h"
#include "server/export/walk.h"
#include "server/recording/verify.h"

namespace wobble::server {

namespace {

// Shows on a terminal how far a recording has been played, until it is asked to stop.
recording::Progress MakeProgress(const std::function<bool()>& isStopAsked) {
  using Clock = std::chrono::steady_clock;
  return [begin = Clock::now(), isTerminal = isatty(STDERR_FILENO) == 1, isStopAsked](double time, double end) {
    const double spent = std::chrono::duration<double>(Clock::now() - begin).count();
    if (isTerminal) fmt::print(stderr, "\r\x1b[K{:.0f} of {:.0f} s, {:.0f} times as fast", time, end, time / spent);
    return !isStopAsked();
  };
}

void EndProgress() {
  if (isatty(STDERR_FILENO) == 1) fmt::print(stderr, "\r\x1b[K");
}

int Fail(const std::string& what) {
  EndProgress();
  fmt::print(stderr, "wobbled: {}\n", what);
  return 2;
}

}  // namespace

int VerifyRecording(const Options& options, const std::function<bool()>& isStopAsked) {
  const recording::Proof proof =
      recording::Verify(options.replayFile, {.threads = options.config.threads}, MakeProgress(isStopAsked));
  EndProgress();
  switch (proof.verdict) {
    case recording::Verdict::kIdentical:
      fmt::print("{}\n", proof.words);
      return 0;
    case recording::Verdict::kDifferent:
      fmt::print("{}\n", proof.words);
      return 1;
    case recording::Verdict::kUnreadable:
      fmt::print(stderr, "wobbled: {}\n", proof.words);
      return 2;
  }
  return 2;
}

int ExportRecording(const Options& options, const std::function<bool()>& isStopAsked) {
  recording::Recording recording;
  std::string error = recording.Open(options.replayFile);
  std::unique_ptr<Playground> ground;
  if (error.empty()) {
    ground = recording::MakeGround(recording.ReadHead(), {.threads = options.config.threads}, error);
  }
  if (ground == nullptr) return Fail(options.replayFile + " " + error);
  const exporting::WalkSettings settings{
      .from = options.exportFrom, .to = options.exportTo, .fps = options.exportFps, .bodies = options.exportBodies};
  const auto plan = exporting::MakePlan(recording, settings, error);
  if (!plan) return Fail(error);
  const bool isVtk = options.exportFormat == "vtk";
  exporting::Output output(options.exportTarget, isVtk);
  error = output.Begin();
  if (!error.empty()) return Fail("--export " + options.exportTarget + ": " + error);
  const std::string& scene = recording.ReadHead().scene.name;
  std::unique_ptr<exporting::FrameWriter> writer;
  if (isVtk) {
    writer = std::make_unique<exporting::VtkWriter>(output.Partial(), output.Target().filename().string());
  } else {
    writer = std::make_unique<exporting::CsvWriter>(output.Partial(), scene);
  }
  recording::Replay replay(recording, *ground);
  const exporting::Walked walked =
      exporting::Walk(recording, replay, *ground, settings, *plan, *writer, MakeProgress(isStopAsked));
  if (!walked.error.empty()) return Fail(options.exportTarget + ": " + walked.error);
  error = output.Commit();
  if (!error.empty()) return Fail(options.exportTarget + ": " + error);
  EndProgress();
  fmt::print("{} frames of {} bodies, up to {:.2f} s, {:.1f} MB in {}\n", walked.frames, walked.bodies, walked.lastTime,
             static_cast<double>(exporting::CountBytes(output.Target())) / 1e6, output.Target().string());
  return 0;
}

}  // namespace wobble::server
