// wobble_lab: shows what the engine is worth, report by report, and whether each figure keeps to its limit.
//
// Exit code 99 when one does not, so that the tests run the very program whose results are stored.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "client/tool/command.h"
#include "tests/bench/report.h"

namespace {

using namespace wobble;
using namespace wobble::bench;

constexpr Report kReports[] = {
    {"contact", "Bounce height, friction angle, momentum, tunnelling, stacks", true, &ReportContact},
};

// 2^53, as the server's: exact as a number in JSON too.
constexpr double kMaxSeed = 9007199254740992.0;
constexpr double kMaxTrial = 1e6;

// The one global: a signal handler can reach nothing else.
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
  words->add_option("--json", options.jsonFile, "Where to write rows and summary")->type_name("FILE");
  words->add_option("--plot", options.plotFolder, "Where to draw plots, as SVG; needs gnuplot")->type_name("DIR");
  words->add_option("--seed", options.seed, "Of all that is drawn by chance")
      ->check(tool::Within(0, kMaxSeed))
      ->capture_default_str();
  if (report.hasTrials) {
    words->add_option("--trial", options.trial, "Plays this random trial alone, the one that a report named")
        ->check(tool::Within(0, kMaxTrial));
  }
  words->set_version_flag("--version", "wobble_lab " WOBBLE_VERSION);
  words->footer("Examples:\n  wobble_lab " + std::string(report.name) + " --quick\n  wobble_lab " + report.name +
                " --json results.json --plot plots");
  return words;
}

int Fail(const std::string& reason) {
  std::fprintf(stderr, "wobble_lab: %s\n", reason.c_str());
  return tool::kExitFailed;
}

// Before anything long begins: what would make its results impossible to keep.
bool CanKeepResults(const Options& options, std::string& error) {
  std::error_code code;
  if (!options.plotFolder.empty()) {
    std::filesystem::create_directories(options.plotFolder, code);
    if (code) error = "--plot: " + options.plotFolder + ": " + code.message();
    if (!HasGnuplot()) error = "--plot: gnuplot is not installed (sh docker/packages.sh lab)";
  }
  if (!options.jsonFile.empty()) {
    const bool isNew = !std::filesystem::exists(options.jsonFile, code);
    if (!std::ofstream(options.jsonFile, std::ios::app)) error = "--json: " + options.jsonFile + " cannot be written";
    if (isNew) std::filesystem::remove(options.jsonFile, code);
  }
  return error.empty();
}

int Run(const Report& report, const Options& options) {
  std::string error;
  if (!CanKeepResults(options, error)) {
    std::fprintf(stderr, "wobble_lab: %s\n", error.c_str());
    return tool::kExitBadUse;
  }
  Results results;
  {
    Progress progress(report.name, 1, [] { return g_stopAsked.load(); });
    Bench bench{options, progress, results};
    report.run(bench);
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
  return results.AreAllKept() ? tool::kExitGood : tool::kExitThresholdFailed;
}

int Run(int argc, char** argv) {
  CLI::App app("wobble_lab: measures the engine and compares it with what it should be");
  app.require_subcommand(0, 1);  // none is refused below: CLI11 would say so even when an unknown option is the fault
  app.set_version_flag("--version", "wobble_lab " WOBBLE_VERSION);
  app.footer(
      "Exit code: 0 every figure keeps to its limit, 99 one does not, 2 bad usage, 1 stopped or failed.\n"
      "Examples:\n"
      "  wobble_lab contact --quick\n"
      "  wobble_lab contact --json contact.json --plot plots\n"
      "  wobble_lab contact --trial 417");
  Options options;
  std::vector<CLI::App*> words;
  std::string names;
  for (const Report& report : kReports) {
    words.push_back(AddReport(app, report, options));
    names += (names.empty() ? "" : ", ") + std::string(report.name);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::fprintf(stderr, "wobble_lab: %s (see wobble_lab --help)\n", error.what());
    return tool::kExitBadUse;
  }
  const auto chosen = std::find_if(words.begin(), words.end(), [](const CLI::App* each) { return each->parsed(); });
  if (chosen == words.end()) {
    std::fprintf(stderr, "wobble_lab: a report is required, one of: %s (see wobble_lab --help)\n", names.c_str());
    return tool::kExitBadUse;
  }
  InstallSignals();
  return Run(kReports[chosen - words.begin()], options);
}

}  // namespace

int main(int argc, char** argv) { return Run(argc, argv); }
