#include "server/program/replaying.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "protocol/version.h"
#include "server/export/csv.h"
#include "server/export/gltf.h"
#include "server/export/output.h"
#include "server/export/vtk.h"
#include "server/export/walk.h"
#include "server/recording/catalogue.h"
#include "server/recording/verify.h"

namespace wobble::server {

namespace {

constexpr std::size_t kMostListed = 100;

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

void Complain(const std::string& what) {
  EndProgress();
  fmt::print(stderr, "wobbled: {}\n", what);
}

int Fail(const std::string& what) {
  Complain(what);
  return 2;
}

// Makes the folder of this option if it is not there. Returns false after it has reported what failed.
bool OpenFolder(const Options& options, const char* option, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK) == 0) return true;
  Fail(options.nameVariables(fmt::format("{} {}: must be a folder that can be written", option, folder)));
  return false;
}

std::unique_ptr<exporting::FrameWriter> MakeWriter(const std::string& format, const exporting::Output& output,
                                                   const std::string& scene) {
  if (format == "vtk") {
    return std::make_unique<exporting::VtkWriter>(output.Partial(), output.Target().filename().string());
  }
  if (format == "gltf") return std::make_unique<exporting::GltfWriter>(output.Partial(), scene);
  return std::make_unique<exporting::CsvWriter>(output.Partial(), scene);
}

recording::Head MakeHead(const Options& options, const scenes::SceneSource& source) {
  return {.version = kVersion,
          .scene = source,
          .tickHz = static_cast<std::uint32_t>(options.config.tickHz),
          .seed = options.config.seed};
}

// Says why the recording ends where it does. Returns whether something was asked for that damage has taken.
bool TellGap(const Options& options, const recording::Recording& recording) {
  if (!recording.Fault().empty()) {
    Complain(fmt::format("{}: exported up to its damage: {}", options.replayFile, recording.Fault()));
  } else if (!recording.IsWhole()) {
    Complain(options.replayFile + ": the recording has no end: what wrote it was broken off");
  }
  return !recording.Fault().empty() && std::isinf(options.exportTo);
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
    case recording::Verdict::kBrokenOff:
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
  const bool isCut = TellGap(options, recording);
  const exporting::WalkSettings settings{
      .from = options.exportFrom, .to = options.exportTo, .fps = options.exportFps, .bodies = options.exportBodies};
  const auto plan = exporting::MakePlan(recording, settings, error);
  if (!plan) return Fail(error);
  exporting::Output output(options.exportTarget, options.exportFormat == "vtk", options.isForced);
  error = output.Begin();
  if (!error.empty()) return Fail(options.exportTarget + " " + error);
  const auto writer = MakeWriter(options.exportFormat, output, recording.ReadHead().scene.name);
  recording::Replay replay(recording, *ground);
  const exporting::Walked walked =
      exporting::Walk(recording, replay, *ground, settings, *plan, *writer, MakeProgress(isStopAsked));
  if (!walked.error.empty()) return Fail(walked.error);
  error = walked.outputError;
  if (error.empty() && !walked.isStopped) error = output.Commit();
  if (!error.empty()) {
    Complain(options.exportTarget + ": " + error);
    return 1;
  }
  if (walked.isStopped) {
    Complain(fmt::format("broken off at {:.1f} s of {:.1f} s: nothing is written", walked.lastTime,
                         recording.TimeOf(plan->TickOf(plan->frames - 1))));
    return 1;
  }
  EndProgress();
  fmt::print("{} frames of {} bodies, up to {:.2f} s, {:.1f} MB in {}\n", walked.frames, walked.bodies, walked.lastTime,
             static_cast<double>(exporting::CountBytes(output.Target())) / 1e6, output.Target().string());
  return isCut ? 1 : 0;
}

int ListRecordings(const Options& options) {
  std::error_code error;
  if (!std::filesystem::is_directory(options.listFolder, error)) {
    return Fail("--list-recordings " + options.listFolder + ": must be a folder");
  }
  if (access(options.listFolder.c_str(), R_OK | X_OK) != 0) {
    return Fail("--list-recordings " + options.listFolder + ": cannot be read");
  }
  using Json = nlohmann::ordered_json;
  for (const recording::CatalogueEntry& each : recording::ListRecordings(options.listFolder, kMostListed)) {
    const auto sinceEpoch = std::chrono::file_clock::to_sys(each.writtenAt).time_since_epoch();
    Json line{{"file", each.file},
              {"scene", each.scene},
              {"seconds", std::round(10 * each.length) / 10},
              {"writtenAt", std::chrono::duration_cast<std::chrono::seconds>(sinceEpoch).count()}};
    if (!each.fault.empty()) line["fault"] = each.fault;
    if (!each.damage.empty()) line["damage"] = each.damage;
    fmt::print("{}\n", line.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  return 0;
}

bool StartFilm(const Options& options, recording::Recording film, Server& server, TimeSource clock) {
  if (!film.Fault().empty()) spdlog::warn("{}: shown up to its damage: {}", options.replayFile, film.Fault());
  const double length = film.TimeOf(film.LastTick());
  const std::string error =
      server.Show(std::make_unique<recording::Film>(options.replayFile, std::move(film), std::move(clock)));
  if (!error.empty()) {
    Fail(options.replayFile + ": " + error);
    return false;
  }
  fmt::print("shows {}, {:.1f} s\n", options.replayFile, length);
  return true;
}

bool StartKeeping(const Options& options, std::span<const scenes::SceneSource> sources, Server& server, double now) {
  if (options.stateFolder.empty()) return true;
  if (!OpenFolder(options, "--state", options.stateFolder)) return false;
  std::vector<recording::Head> heads;
  for (const scenes::SceneSource& source : sources) heads.push_back(MakeHead(options, source));
  auto checkpoints = std::make_unique<recording::Checkpoints>(options.stateFolder, std::move(heads));
  if (const std::string error = checkpoints->Claim(); !error.empty()) {
    Fail(fmt::format("--state {}: {}", options.stateFolder, error));
    return false;
  }
  const recording::FoundCheckpoint found = checkpoints->FindNewest();
  if (!found.conflict.empty()) {
    Fail(fmt::format("--state {}: {}: empty the folder or name another", options.stateFolder, found.conflict));
    return false;
  }
  for (const std::string& complaint : found.complaints) spdlog::warn("--state: {}", complaint);
  if (found.checkpoint) {
    const std::string error = server.Resume(*found.checkpoint, now);
    if (!error.empty()) {
      Fail(fmt::format("--state {}: the newest checkpoint cannot be played: {}", options.stateFolder, error));
      return false;
    }
  }
  server.KeepState(std::move(checkpoints));
  return true;
}

bool StartRecording(const Options& options, const scenes::SceneSource& source, Server& server,
                    std::uint64_t (*readUnixTime)()) {
  if (options.recordFolder.empty()) return true;
  if (!OpenFolder(options, "--record", options.recordFolder)) return false;
  server.Record({.folder = options.recordFolder,
                 .maxFileBytes = static_cast<std::uint64_t>(options.recordMib) << 20,
                 .readUnixTime = readUnixTime},
                MakeHead(options, source));
  fmt::print("recording into {}; files are named after scene and time, and end in .wobrec\n", options.recordFolder);
  return true;
}

}  // namespace wobble::server
