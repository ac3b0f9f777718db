// wobble: the client's tool. The command line and the signals; each command is a folder beside this file.
//
// All that is wrong with a command line is said in one line, with the option, the value and what is allowed, and ends
// the program with exit code 2 before anything has started.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>

#include "client/bots/load_test.h"
#include "client/play/play.h"

namespace {

using namespace wobble;

constexpr int kBadUse = 2;

// The one global: a signal handler can reach nothing else.
std::atomic<bool> g_stopAsked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// Again and again the same flag, so a second Ctrl-C changes nothing. No restart of system calls: waits end early.
void InstallSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stopAsked = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool IsStopAsked() { return g_stopAsked; }

std::filesystem::path FindProgramFolder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

// A script that lies nowhere at hand but has the bare name of a shipped one is that one.
std::string FindScript(const std::string& name) {
  const auto shipped = FindProgramFolder() / "scripts" / name;
  std::error_code error;
  const bool bare = name.find('/') == std::string::npos;
  return bare && !std::filesystem::exists(name, error) && std::filesystem::exists(shipped, error) ? shipped.string()
                                                                                                  : name;
}

// CLI::Range lets "nan" through.
CLI::Validator Within(double least, double most) {
  char range[64];
  std::snprintf(range, sizeof range, "%g to %.10g", least, most);
  const std::string allowed = range;
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0;
        const bool isNumber = CLI::detail::lexical_cast(text, value);
        return isNumber && value >= least && value <= most ? std::string() : "'" + text + "' is not " + allowed;
      },
      allowed);
}

// What the bots command's words say before they are understood.
struct BotsWords {
  std::string address;
  std::string decodeShare = "1/32";
  std::vector<std::string> thresholds;
  double statusEvery = -1;
};

CLI::App* DescribeBots(CLI::App& app, bots::LoadTestOptions& options, BotsWords& words) {
  CLI::App* command =
      app.add_subcommand("bots", "Runs scripted players against a server and measures how they are served");
  // Not required() of CLI11: it would complain of that even when an unknown option is the fault.
  command->add_option("server", words.address, "The server")->type_name("HOST:PORT REQUIRED");
  command->add_option("--script", options.scriptFile, "Lua file, or the name of a shipped one: idle.lua, wander.lua")
      ->type_name("FILE REQUIRED");
  command->add_option("--count", options.count, "Bots")->check(Within(1, bots::kMaxBots))->capture_default_str();
  command->add_option("--ramp", options.ramp, "Seconds over which they join")
      ->check(Within(0, bots::kMaxDuration))
      ->capture_default_str();
  command->add_option("--for", options.duration, "Seconds to run, the ramp included; 0: until Ctrl-C")
      ->check(Within(0, bots::kMaxDuration))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Of all that the scripts draw by chance")->capture_default_str();
  command
      ->add_option("--threshold", words.thresholds,
                   "What must hold at the end: a key of the summary, < <= > >= == or !=, and a number; repeatable")
      ->type_name("RULE")
      ->allow_extra_args(false);
  command->add_option("--decode-share", words.decodeShare, "Share of the bots that decode and interpolate in full")
      ->type_name("A/B")
      ->capture_default_str();
  command->add_option("--summary", options.summaryFile, "Where to write the figures as JSON")->type_name("FILE");
  command->add_option("--status", words.statusEvery, "Seconds between status lines, 0: none (1 on a terminal, else 0)")
      ->check(Within(0, bots::kMaxDuration));
  command->add_option("--protocol-version", options.protocolVersion, "For testing servers: the version to claim")
      ->check(Within(0, 65535))
      ->capture_default_str();
  command->footer(
      "Exit code: 0 all thresholds hold, 99 one fails, 2 bad usage, broken script or no server.\n"
      "Examples:\n"
      "  wobble bots 127.0.0.1:7777 --script wander.lua --count 32 --ramp 2 --for 20\n"
      "  wobble bots example.org:7777 --script my.lua --count 200 --ramp 30 --for 300 \\\n"
      "    --threshold 'disconnects==0' --threshold 'snapshot_age_ms_p99<150' --summary figures.json");
  return command;
}

// False with one line in `error`.
bool Understand(const BotsWords& words, bots::LoadTestOptions& options, std::string& error) {
  const auto blame = [&error](const char* option) {
    error = std::string(option) + ": " + error;
    return false;
  };
  if (words.address.empty() || options.scriptFile.empty()) {
    error = words.address.empty() ? "HOST:PORT of the server is required (see wobble bots --help)"
                                  : "--script is required (see wobble bots --help)";
    return false;
  }
  const auto address = bots::ParseAddress(words.address, error);
  if (!address) return blame("server");
  const auto share = bots::ParseDecodeShare(words.decodeShare, error);
  if (!share) return blame("--decode-share");
  for (const std::string& rule : words.thresholds) {
    const auto threshold = bots::ParseThreshold(rule, error);
    if (!threshold) return blame("--threshold");
    options.thresholds.push_back(*threshold);
  }
  options.server = *address;
  options.decodeShare = *share;
  options.scriptFile = FindScript(options.scriptFile);
  if (words.statusEvery >= 0) options.statusEvery = words.statusEvery;
  return true;
}

CLI::App* DescribePlay(CLI::App& app, play::PlayOptions& options) {
  CLI::App* command =
      app.add_subcommand("play", "Starts a server and some bots, shows how they do, and ends them together");
  command->add_option("--for", options.duration, "Seconds to run; 0: until Ctrl-C")
      ->check(Within(0, bots::kMaxDuration))
      ->capture_default_str();
  command->add_option("--port", options.port, "UDP port of the server")->check(Within(1, 65535))->capture_default_str();
  command->add_option("--bots", options.bots, "Bots that wander about")
      ->check(Within(0, bots::kMaxBots))
      ->capture_default_str();
  command->add_option("--scene", options.scene, "A shipped scene's name or a scene file")->capture_default_str();
  command->footer(
      "Exit code: 0 nothing failed, 1 something did, 2 the server cannot start with these options.\n"
      "Examples:\n"
      "  wobble play\n"
      "  wobble play --for 20 --bots 12 --port 7801");
  return command;
}

int Run(int argc, char** argv) {
  CLI::App app("wobble: tools for players and testers of wobbled, the server of soft bodies");
  app.require_subcommand(0, 1);  // none is refused below: CLI11 would say so even when an unknown option is the fault
  bots::LoadTestOptions botsOptions;
  BotsWords words;
  play::PlayOptions playOptions;
  CLI::App* botsCommand = DescribeBots(app, botsOptions, words);
  CLI::App* playCommand = DescribePlay(app, playOptions);
  for (CLI::App* each : {&app, botsCommand, playCommand}) each->set_version_flag("--version", "wobble " WOBBLE_VERSION);
  app.footer("Examples:\n  wobble play --for 20\n  wobble bots --help");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::fprintf(stderr, "wobble: %s (see wobble --help)\n", error.what());
    return kBadUse;
  }

  if (app.get_subcommands().empty()) {
    std::fprintf(stderr, "wobble: a command is required, bots or play (see wobble --help)\n");
    return kBadUse;
  }
  InstallSignals();
  if (!botsCommand->parsed()) {
    playOptions.programFolder = FindProgramFolder();
    return play::RunPlay(playOptions, &IsStopAsked);
  }
  std::string error;
  if (Understand(words, botsOptions, error)) return bots::RunLoadTest(botsOptions, &IsStopAsked);
  std::fprintf(stderr, "wobble bots: %s\n", error.c_str());
  return kBadUse;
}

}  // namespace

int main(int argc, char** argv) { return Run(argc, argv); }
