#include "client/host/command.h"

#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <memory>

#include "client/host/check.h"
#include "client/host/fleet.h"
#include "client/host/make_plan.h"
#include "protocol/transport/vestibule/key_file.h"
#include "protocol/usage/command_line.h"
#include "protocol/usage/terminal.h"

namespace wobble::host {
namespace {

namespace fs = std::filesystem;

struct HostWords {
  std::string file;
  bool isCheck = false;
  double duration = 0;
  double statusEvery = isatty(STDOUT_FILENO) != 0 ? 1 : 0;
};

// The folder of worlds that several wobbles of this user share, unless the file names another.
fs::path FindDefaultFolder() {
  const fs::path folder = transport::vestibule::FindStateFile("worlds");
  return folder.empty() ? fs::path("worlds") : folder;
}

// The only global: a signal handler can reach nothing else.
volatile std::sig_atomic_t g_hangup = 0;

// nullopt after every mistake is named.
std::optional<Plan> MakePlan(const HostWords& words) {
  Plan plan;
  plan.command = "wobble host";
  plan.programFolder = command::FindProgramFolder();
  plan.duration = words.duration;
  plan.statusEvery = words.statusEvery;
  const WorldsFile file = LoadWorlds(words.file, ReadEnvironment());
  const fs::path folder = FindStateFolder(file, FindDefaultFolder());
  std::vector<std::string> errors = file.errors;
  const std::vector<std::string> others = CheckWithPrograms(file, folder, plan.programFolder);
  errors.insert(errors.end(), others.begin(), others.end());
  SortByLine(errors);
  for (const std::string& error : errors) std::fprintf(stderr, "wobble host: %s\n", error.c_str());
  if (!errors.empty()) return {};
  for (const World& world : file.worlds) plan.worlds.push_back(MakeWorldPlan(file, world, folder));
  if (file.hasGateway) plan.gateway = MakeGatewayPlan(file, folder);
  return plan;
}

void MakeStateFolders(const Plan& plan) {
  std::error_code ignored;  // the world says it
  for (const WorldPlan& world : plan.worlds) fs::create_directories(world.state, ignored);
}

int RunHost(const HostWords& words, const command::IsStopAsked& isStopAsked) {
  const std::optional<Plan> plan = MakePlan(words);
  if (!plan) return command::kExitBadUse;
  if (words.isCheck) {
    std::printf("%s: %zu worlds%s, no mistake\n", words.file.c_str(), plan->worlds.size(),
                plan->gateway ? " and a gateway" : "");
    return command::kExitGood;
  }
  MakeStateFolders(*plan);
  // SIGHUP of a terminal that is closed ends all; any other one has the file read again.
  const bool hadTerminal = usage::HasTerminal();
  struct sigaction action {};
  action.sa_handler = [](int) { g_hangup = 1; };
  sigaction(SIGHUP, &action, nullptr);
  bool isClosed = false;
  const auto takePlan = [&]() -> std::optional<Plan> {
    if (g_hangup == 0) return {};
    g_hangup = 0;
    isClosed = hadTerminal && !usage::HasTerminal();
    if (isClosed) return {};
    std::optional<Plan> next = MakePlan(words);
    std::fprintf(stderr,
                 next ? "wobble host: %s is read again\n" : "wobble host: %s has mistakes: all goes on as it was\n",
                 words.file.c_str());
    if (next) MakeStateFolders(*next);
    return next;
  };
  return RunFleet(
      *plan, [&] { return isClosed || isStopAsked(); }, takePlan);
}

}  // namespace

command::Command DescribeHost(CLI::App& app) {
  const auto words = std::make_shared<HostWords>();
  CLI::App* subcommand =
      app.add_subcommand("host", "Runs the worlds of a file, a page for them and bots, and starts again what dies");
  subcommand->add_option("file,--file", words->file, "The file; default: the worlds.toml that is shipped")
      ->type_name("FILE");
  subcommand->add_flag("--check", words->isCheck, "Only name every mistake in the file, exit code 2, or none, 0");
  usage::AddDuration(*subcommand, "--for", words->duration, "How long to run; 0: until Ctrl-C");
  usage::AddDuration(*subcommand, "--status", words->statusEvery, "Time between status lines on stdout; 0: none")
      ->default_str("1 on a terminal, else 0");
  subcommand->footer(
      "Every key of the file can be set by the environment, too: WOBBLE_HTTP=80 in [gateway], WOBBLE_MAX_CLIENTS=32\n"
      "for all worlds that do not say it themselves, WOBBLE_WORLD_ARENA_PORT=7790 for the world arena.\n"
      "SIGHUP has the file read again: worlds that it does not have any more end, new ones begin, and the others go "
      "on.\n"
      "server/HOSTING.md in the sources has all keys.\n"
      "Exit code: 0 nothing failed (what died and came back has not), 1 something did, 2 the file, a variable or a "
      "port\n"
      "is unusable; then nothing is left running.\n"
      "Examples:\n"
      "  wobble host                        the worlds that are shipped\n"
      "  wobble host worlds.toml --check\n"
      "  WOBBLE_HTTP=80 wobble host /etc/wobble/worlds.toml");
  return {subcommand,
          [words](const command::IsStopAsked& isStopAsked) {
            if (words->file.empty()) words->file = command::FindShipped("worlds.toml");
            return RunHost(*words, isStopAsked);
          },
          true};
}

}  // namespace wobble::host
