// wobble_lab: measures the engine report by report and checks each figure against its limit.
//
// It exits with code 99 when a figure breaks its limit, so that the tests run the very program whose results are
// stored.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>

#include "client/bots/options.h"
#include "client/bots/script.h"
#include "client/command/command.h"
#include "protocol/version.h"
#include "server/config.h"
#include "server/scenes/loader.h"
#include "tests/bench/report.h"

namespace {

using namespace wobble;
using namespace wobble::bench;

constexpr Report kReports[] = {
    {.name = "accuracy",
     .shows = "Run time against error of every method, step and precision",
     .hasTrials = false,
     .run = &ReportAccuracy},
    {.name = "stability",
     .shows = "The largest stable step of every method against theory; random trials",
     .hasTrials = true,
     .run = &ReportStability,
     .hasRecordings = true,
     .hasDepth = true},
    {.name = "contact",
     .shows = "Bounce height, friction angle, momentum, tunnelling, stacks",
     .hasTrials = true,
     .run = &ReportContact},
    {.name = "throughput",
     .shows = "Cost of steps and ticks against plain code, Bullet and the peak of the core",
     .hasTrials = false,
     .run = &ReportThroughput},
    {.name = "skip",
     .shows = "Cost of features not in use: sleeping bodies, absent terms, bodies apart, no client",
     .hasTrials = false,
     .run = &ReportSkip},
    {.name = "codec",
     .shows = "Bits per vertex against error: ours, Rigs of Rods, Draco, meshoptimizer and deltas",
     .hasTrials = false,
     .run = &ReportCodec},
    {.name = "interpolation",
     .shows = "Error of what players see, over links with loss and delay",
     .hasTrials = false,
     .run = &ReportInterpolation},
    {.name = "link",
     .shows = "How late players see the world over real networks: UDP, and the browser's TCP",
     .hasTrials = false,
     .run = &ReportLink},
    {.name = "capacity",
     .shows = "How many players a core can host, and what each gets and sees",
     .hasTrials = false,
     .run = &ReportCapacity,
     .hasPlayers = true,
     .hasRecordings = true},
};

// 2^53, as for the server: exact as a JSON number.
constexpr double kMaxSeed = 9007199254740992.0;
constexpr double kMaxTrial = 1e6;
constexpr double kMaxPlayers = 2000;

// The only global: a signal handler can reach nothing else.
std::atomic<bool> g_stopAsked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void InstallSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stopAsked = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

CLI::App* AddReport(CLI::App& app, const Report& report, Options& options) {
  CLI::App* words = app.add_subcommand(report.name, report.shows);
  words->add_flag("--quick", options.quick, "Fewer and shorter trials: under 40 s on two cores");
  words->add_option("--json", options.jsonFile, "Write rows and summary to this file")->type_name("FILE");
  words->add_option("--plot", options.plotFolder, "Draw plots as SVG into this folder; needs gnuplot")
      ->type_name("DIR");
  words->add_option("--seed", options.seed, "Seed of all random draws")
      ->check(command::Within(0, kMaxSeed))
      ->capture_default_str();
  words->add_option("--part", options.part, "Only the parts with this word in their names, as progress shows them")
      ->type_name("WORD");
  if (report.hasTrials) {
    words->add_option("--trial", options.trial, "Play only this random trial, numbered as in a report")
        ->check(command::Within(0, kMaxTrial));
  }
  if (report.hasDepth) {
    words
        ->add_option("--depth", options.depth,
                     "A random trial fails, too, when a vertex is deeper in another body or the ground than this share "
                     "of its body's size")
        ->check(command::Within(0, 10));
  }
  if (report.hasPlayers) {
    words->add_option("--scene", options.scene, "Scene of the players: a shipped scene, or a path to a .toml file")
        ->capture_default_str();
    words
        ->add_option("--script", options.script,
                     "Script of the players: a Lua file, or a shipped one: idle.lua, wander.lua, chase.lua, mash.lua")
        ->capture_default_str();
    words->add_option("--players", options.players, "Only this player count, for five minutes unless --quick")
        ->check(command::Within(1, kMaxPlayers));
  }
  if (report.hasRecordings) {
    const std::string what = report.hasPlayers
                                 ? "Folder to keep the worst ten seconds of each player count in, as a recording that "
                                   "`wobble watch` shows; ticks then have the cost of recording"
                                 : std::string("Folder for recordings of trials that fail (") + kRecordings +
                                       " if not given), and of the one of --trial, whatever becomes of it";
    words->add_option("--recordings", options.recordings, what)->type_name("DIR");
  }
  words->set_version_flag("--version", std::string("wobble_lab ") + kVersion);
  const std::string line = "\n  wobble_lab " + std::string(report.name);
  words->footer("Examples:" + line + " --quick" + line + " --json results.json --plot plots" +
                (report.hasTrials && report.hasRecordings ? line + " --trial 417 --recordings trials" : ""));
  return words;
}

CLI::App* AddAll(CLI::App& app, Options& options, std::string& folder) {
  CLI::App* words = app.add_subcommand("all", "Run every report, with its JSON and plots");
  words->add_flag("--quick", options.quick, "Fewer and shorter trials");
  words
      ->add_option("--into", folder,
                   "Write results to a folder in DIR, named after this processor and its instruction "
                   "set; needs gnuplot")
      ->type_name("DIR")
      ->capture_default_str();
  words->add_option("--seed", options.seed, "Seed of all random draws")
      ->check(command::Within(0, kMaxSeed))
      ->capture_default_str();
  words->footer("Examples:\n  wobble_lab all --quick\n  wobble_lab all --into tests/bench/results");
  return words;
}

int Fail(const std::string& reason) {
  std::fprintf(stderr, "wobble_lab: %s\n", reason.c_str());
  return command::kExitFailed;
}

// Checks before any long run that results can be written.
bool CanKeepResults(const Options& options, std::string& error) {
  std::error_code code;
  if (!options.plotFolder.empty()) {
    std::filesystem::create_directories(options.plotFolder, code);
    if (code) error = "--plot: " + options.plotFolder + ": " + code.message();
    if (!HasGnuplot()) error = "--plot: gnuplot is not installed (sh docker/packages.sh lab)";
  }
  if (!options.recordings.empty()) {
    std::filesystem::create_directories(options.recordings, code);
    if (code) error = "--recordings: " + options.recordings + ": " + code.message();
  }
  if (!options.jsonFile.empty()) {
    const bool isNew = !std::filesystem::exists(options.jsonFile, code);
    if (!std::ofstream(options.jsonFile, std::ios::app)) error = "--json: " + options.jsonFile + " cannot be written";
    if (isNew) std::filesystem::remove(options.jsonFile, code);
  }
  return error.empty();
}

// Reports the first fault of a scene that cannot be hosted; wobbled reports all.
bool CanPlay(const Options& options, std::string& error) {
  const scenes::LoadResult loaded = scenes::LoadScene(options.scene, scenes::FindShippedScenes());
  std::vector<std::string> errors = loaded.errors;
  if (errors.empty()) errors = server::Validate({}, loaded.scene);
  if (!errors.empty()) {
    error = "--scene: " + errors.front();
    return false;
  }
  bots::Script script(options.seed, [](unsigned, std::string_view) {});
  if (script.LoadFile(bots::FindScriptFile(options.script), error)) return true;
  error = "--script: " + error;
  return false;
}

// Most reports play shipped scenes.
bool HasScenes(std::string& error) {
  const std::filesystem::path folder = scenes::FindShippedScenes();
  std::error_code code;
  if (std::filesystem::is_directory(folder, code)) return true;
  error = "the shipped scenes are neither in a folder 'scenes' beside this program nor in " + folder.string();
  return false;
}

int Run(const Report& report, const Options& options) {
  std::string error;
  if (!HasScenes(error) || !CanKeepResults(options, error) || (report.hasPlayers && !CanPlay(options, error))) {
    std::fprintf(stderr, "wobble_lab: %s\n", error.c_str());
    return command::kExitBadUse;
  }
  Results results;
  {
    Progress progress(report.name, [] { return g_stopAsked.load(); });
    Bench bench{options, progress, results};
    try {
      report.run(bench);
    } catch (const UnknownPart& unknown) {
      std::fprintf(stderr, "wobble_lab: --part: %s\n", unknown.what());
      return command::kExitBadUse;
    }
  }
  if (g_stopAsked) return Fail("stopped before it was done: no results");
  std::printf("wobble_lab %s%s, seed %llu\n%s", report.name, options.quick ? " --quick" : "",
              static_cast<unsigned long long>(options.seed), FormatText(results).c_str());
  if (!options.jsonFile.empty()) {
    std::ofstream file(options.jsonFile, std::ios::trunc);
    if (!(file << FormatJson(results) << std::flush)) return Fail("--json: " + options.jsonFile + " cannot be written");
  }
  for (const Plot& plot : results.plots) {
    if (!options.plotFolder.empty() && !DrawPlot(plot, options.plotFolder, error)) return Fail(error);
  }
  return results.AreAllKept() ? command::kExitGood : command::kExitThresholdFailed;
}

// "AMD EPYC 9B14" -> "amd_epyc_9b14_avx512", "Intel(R) Xeon(R) Processor @ 2.50GHz" -> "intel_xeon_avx512".
std::string MakeFolderName(const std::string& cpu) {
  static const std::regex empty("\\((R|TM)\\)|\\b(CPU|Processor)\\b|@.*", std::regex::icase);
  std::string name;
  for (const char c : std::regex_replace(cpu, empty, " ")) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name + "_" + ReadInstructionSet();
}

// A report with a missed figure does not stop the following ones; a report that fails does.
int RunAll(Options options, const std::string& folder) {
  options.plotFolder = folder + "/" + MakeFolderName(ReadCpuName());
  std::error_code code;
  std::filesystem::create_directories(options.plotFolder, code);
  if (code) {
    std::fprintf(stderr, "wobble_lab: --into: %s: %s\n", options.plotFolder.c_str(), code.message().c_str());
    return command::kExitBadUse;
  }
  int worst = command::kExitGood;
  for (const Report& report : kReports) {
    options.jsonFile = options.plotFolder + "/" + report.name + ".json";
    const int exit = Run(report, options);
    if (exit == command::kExitFailed || exit == command::kExitBadUse) return exit;
    worst = std::max(worst, exit);
    std::fflush(stdout);
  }
  std::printf("results are in %s\n", options.plotFolder.c_str());
  return worst;
}

int Run(int argc, char** argv) {
  CLI::App app("wobble_lab: measures the engine and checks the figures against their limits");
  // A missing report is refused below: CLI11 would complain about it even when an unknown option is the fault
  app.require_subcommand(0, 1);
  app.set_version_flag("--version", std::string("wobble_lab ") + kVersion);
  app.footer(
      "Exit code: 0 every figure keeps its limit, 99 one does not, 2 bad usage, 1 stopped or failed.\n"
      "Examples:\n"
      "  wobble_lab accuracy --quick\n"
      "  wobble_lab contact --json contact.json --plot plots\n"
      "  wobble_lab stability --trial 417\n"
      "  wobble_lab all --into tests/bench/results");
  Options options;
  std::vector<CLI::App*> words;
  std::string names;
  for (const Report& report : kReports) {
    words.push_back(AddReport(app, report, options));
    names += (names.empty() ? "" : ", ") + std::string(report.name);
  }
  std::string allFolder = "wobble_lab_results";
  const CLI::App* const all = AddAll(app, options, allFolder);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::fprintf(stderr, "wobble_lab: %s (see wobble_lab --help)\n", error.what());
    return command::kExitBadUse;
  }
  InstallSignals();
  if (all->parsed()) return RunAll(options, allFolder);
  const auto chosen = std::find_if(words.begin(), words.end(), [](const CLI::App* each) { return each->parsed(); });
  if (chosen == words.end()) {
    std::fprintf(stderr, "wobble_lab: a report is required, one of: %s, or all (see wobble_lab --help)\n",
                 names.c_str());
    return command::kExitBadUse;
  }
  return Run(kReports[chosen - words.begin()], options);
}

}  // namespace

int main(int argc, char** argv) { return Run(argc, argv); }
