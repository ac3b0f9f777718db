// A report of the laboratory: experiments whose figures are compared with limits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "tests/bench/progress.h"
#include "tests/bench/results.h"

namespace wobble::bench {

// A scene with as many bodies as players, of 162 vertices, that touch by the dozen.
inline constexpr const char* kCapacityScene = "pitch";
inline constexpr const char* kCapacityScript = "chase.lua";

inline constexpr const char* kRecordings = "lab_recordings";

// The command line's options.
struct Options {
  bool quick = false;  // under 40 s on two cores
  std::string jsonFile;
  std::string plotFolder;
  std::uint64_t seed = 1;
  std::optional<double> depth;         // a random trial fails, too, where a vertex is deeper, share of its body's size
  std::string part;                    // only parts with this in their names; empty: all
  std::optional<std::uint32_t> trial;  // only this random trial
  std::string scene = kCapacityScene;  // of `capacity`: a shipped scene or a file
  std::string script = kCapacityScript;  // of the bots of `capacity`: a shipped script or a file
  std::optional<unsigned> players;       // of `capacity`: only this player count
  std::string recordings;                // folder; empty: kRecordings for trials that fail, and no others
};

// The context of a report. Experiments check progress.IsStopAsked() between trials and return early.
struct Bench {
  const Options& options;
  Progress& progress;
  Results& results;
};

// A part of a report, in order of measurement.
struct Part {
  const char* name;
  double share;  // of the time of all parts, in any unit
  void (*measure)(Bench& bench);
  bool hasTrials = false;  // --trial plays one of its trials
};
// No part has this word in its name; what() lists the names.
class UnknownPart : public std::runtime_error {
  using std::runtime_error::runtime_error;
};
// Runs the parts until a stop is asked for; with --trial only the part that has trials, with --part those that it
// names. Throws UnknownPart.
void MeasureParts(Bench& bench, std::span<const Part> parts);

struct Report {
  const char* name;
  const char* shows;  // one line
  bool hasTrials;     // takes --trial
  void (*run)(Bench& bench);
  bool hasPlayers = false;     // takes --scene, --script and --players
  bool hasRecordings = false;  // takes --recordings
  bool hasDepth = false;       // takes --depth
};

// One function per report, each in the file of its name.
void ReportAccuracy(Bench& bench);
void ReportCapacity(Bench& bench);
void ReportCodec(Bench& bench);
void ReportContact(Bench& bench);
void ReportInterpolation(Bench& bench);
void ReportLink(Bench& bench);
void ReportSkip(Bench& bench);
void ReportStability(Bench& bench);
void ReportThroughput(Bench& bench);

}  // namespace wobble::bench
