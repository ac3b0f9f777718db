// `wobble list`: the worlds of the local network, or of a public list, and what is played in them.
#include "client/list/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "client/list/ask.h"
#include "client/list/lan.h"
#include "client/list/public_list.h"
#include "client/list/table.h"
#include "protocol/text.h"
#include "protocol/usage/command_line.h"

namespace wobble::list {
namespace {

constexpr double kAskSeconds = 1.5;

struct ListWords {
  std::string from;
  double seconds = 2;
  bool isJson = false;
};

int RunList(const ListWords& words, const command::IsStopAsked& stopAsked) {
  const auto complain = [](const std::string& error, int code) {
    std::fprintf(stderr, "wobble list: %s\n", protocol::MakeLine(error, protocol::kMaxShownBytes).c_str());
    return code;
  };
  std::string error;
  std::vector<World> worlds =
      words.from.empty() ? BrowseLan(words.seconds, stopAsked, error) : ReadList(words.from, error);
  if (!error.empty()) return complain(error, words.from.empty() ? command::kExitFailed : command::kExitBadUse);
  if (!AskWorlds(worlds, kAskSeconds, stopAsked, error)) return complain(error, command::kExitFailed);
  // Those that answer first, the nearest of them first.
  std::stable_sort(worlds.begin(), worlds.end(),
                   [](const World& a, const World& b) { return a.ping.value_or(1e9) < b.ping.value_or(1e9); });
  if (words.isJson || !worlds.empty()) {
    std::fputs((words.isJson ? WriteJson(worlds) : WriteTable(worlds)).c_str(), stdout);
  }
  if (!worlds.empty()) return command::kExitGood;
  return complain("no world is announced in the local network (wobbled --announce)", command::kExitFailed);
}

}  // namespace

command::Command DescribeList(CLI::App& app) {
  const auto words = std::make_shared<ListWords>();
  CLI::App* subcommand = app.add_subcommand("list", "Finds worlds in the local network, and asks what is played there");
  subcommand
      ->add_option("--from", words->from, "A public list instead: a file, or an address that begins with http(s)://")
      ->type_name("URL or FILE");
  usage::AddDuration(*subcommand, "--for", words->seconds, "How long to listen for announcements");
  subcommand->add_flag("--json", words->isJson, "Print JSON instead of a table");
  subcommand->footer(
      "Exit code: 0 worlds were found, 1 none, 2 bad usage or no list there.\n"
      "Examples:\n"
      "  wobble list                         worlds of servers started with --announce\n"
      "  wobble list --for 5 --json\n"
      "  wobble list --from worlds.json\n"
      "  wobble list --from https://play.example.org/worlds.json");
  return {subcommand, [words](const command::IsStopAsked& stopAsked) { return RunList(*words, stopAsked); }};
}

}  // namespace wobble::list
