// wobble, the tool of players and testers: its commands and the handling of signals. Each command is a folder beside
// this file.
//
// An error in the command line is reported in one line, with the option, the value and the range, and ends the program
// with exit code 2 before anything has started.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include "client/admin/command.h"
#include "client/bots/command.h"
#include "client/command/command.h"
#include "client/export/command.h"
#include "client/gateway/command.h"
#include "client/health/command.h"
#include "client/host/command.h"
#include "client/link/command.h"
#include "client/list/command.h"
#include "client/play/command.h"
#include "client/terminal/command.h"
#include "client/token/command.h"
#include "protocol/usage/command_line.h"
#include "protocol/version.h"

namespace {

using namespace wobble;

// The only global: a signal handler can reach nothing else.
std::atomic<bool> g_stopAsked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// Every signal sets the same flag, so a second Ctrl-C changes nothing. System calls are not restarted: waits end early.
void InstallSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stopAsked = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool IsStopAsked() { return g_stopAsked; }

int Run(int argc, char** argv) {
  CLI::App app("wobble: tools for players and testers of wobbled, the server for soft bodies");
  // 0, since no command is refused below: CLI11 would report that even when an unknown option is the fault.
  app.require_subcommand(0, 1);
  const std::vector<command::Command> commands{
      play::DescribePlay(app),        host::DescribeHost(app),       terminal::DescribeWatch(app),
      bots::DescribeBots(app),        gateway::DescribeGateway(app), list::DescribeList(app),
      link::DescribeLink(app),        health::DescribeHealth(app),   admin::DescribeAdmin(app),
      exporting::DescribeExport(app), token::DescribeToken(app)};
  const std::string version = std::string("wobble ") + kVersion;
  app.set_version_flag("--version", version);
  for (const command::Command& each : commands) {
    each.words->set_version_flag("--version", version);
    usage::RefuseEmptyWords(*each.words);
  }
  app.footer("Examples:\n  wobble play --for 20\n  wobble bots --help");
  app.name("wobble");
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto isAsked = [&](const command::Command& each) {
    return !arguments.empty() && each.words->get_name() == arguments.front();
  };
  const auto chosen = std::find_if(commands.begin(), commands.end(), isAsked);
  const bool isChosen = chosen != commands.end();
  if (isChosen && chosen->takesEnvironment) arguments = usage::AddEnvironment(*chosen->words, std::move(arguments));
  try {
    usage::Parse(app, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    const std::string name = isChosen ? "wobble " + chosen->words->get_name() : "wobble";
    const std::string what = usage::Explain(isChosen ? *chosen->words : app, error, arguments);
    std::fprintf(stderr, "%s: %s (see %s --help)\n", name.c_str(), what.c_str(), name.c_str());
    return command::kExitBadUse;
  }
  if (!isChosen) {
    std::string names;
    for (const command::Command& each : commands) names += (names.empty() ? "" : ", ") + each.words->get_name();
    std::fprintf(stderr, "wobble: a command is required, one of: %s (see wobble --help)\n", names.c_str());
    return command::kExitBadUse;
  }
  InstallSignals();
  return chosen->run(&IsStopAsked);
}

}  // namespace

int main(int argc, char** argv) { return Run(argc, argv); }
