// A report of the laboratory: an experiment whose figures are compared with what they should be.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "tests/bench/progress.h"
#include "tests/bench/results.h"

namespace wobble::bench {

// As many bodies as players, of 162 vertices, who meet by the dozen.
inline constexpr const char* kCapacityScene = "pitch";
inline constexpr const char* kCapacityScript = "chase.lua";

// As the command line has them.
struct Options {
  bool quick = false;  // answers within 40 s on two cores
  std::string jsonFile;
  std::string plotFolder;
  std::uint64_t seed = 1;
  std::optional<std::uint32_t> trial;    // only this one of the random trials
  std::string scene = kCapacityScene;    // that the players of `capacity` are in: a shipped one, or a file
  std::string script = kCapacityScript;  // by which they play: a shipped one, or a file
  std::optional<unsigned> players;       // only this count of them
};

// What a report is given. It looks at progress.IsStopAsked() between trials and then returns early.
struct Bench {
  const Options& options;
  Progress& progress;
  Results& results;
};

// Of a report, in the order in which they are measured.
struct Part {
  const char* name;
  double share;  // of the time that all take together
  void (*measure)(Bench& bench);
  bool hasTrials = false;  // those that --trial plays one of
};
// Until it is asked to stop; with --trial only the part that has trials.
void MeasureParts(Bench& bench, std::span<const Part> parts);

struct Report {
  const char* name;
  const char* shows;  // in one line
  bool hasTrials;     // takes --trial
  void (*run)(Bench& bench);
  bool hasPlayers = false;  // takes --scene, --script and --players
};

// One function a report, each in the file of its name.
void ReportAccuracy(Bench& bench);
void ReportCapacity(Bench& bench);
void ReportCodec(Bench& bench);
void ReportContact(Bench& bench);
void ReportInterpolation(Bench& bench);
void ReportSkip(Bench& bench);
void ReportStability(Bench& bench);
void ReportThroughput(Bench& bench);

}  // namespace wobble::bench
