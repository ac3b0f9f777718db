#include "client/bots/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "client/bots/load_test.h"
#include "client/command/access.h"
#include "protocol/usage/duration.h"

namespace wobble::bots {
namespace {

// 2^53, the server's limit as well: every integer up to it is exact as a number in JSON.
constexpr double kMaxSeed = 9007199254740992.0;

// Options as text, before they are parsed.
struct Words {
  command::Access access;
  std::string address;
  std::string decodeShare = "1/32";
  std::vector<std::string> thresholds;
  std::vector<std::string> stages;
  std::string ramp;
  std::string duration;
  std::string statusEvery;
  std::string link;
  std::string rejoin;
};

CLI::App* AddWords(CLI::App& app, LoadTestOptions& options, Words& words) {
  CLI::App* subcommand =
      app.add_subcommand("bots", "Runs scripted players against a server and measures how they are served");
  // CLI11's required() is not used: it reports the missing address even when an unknown option is the fault.
  subcommand->add_option("server", words.address, "The server")->type_name("HOST:PORT REQUIRED");
  subcommand
      ->add_option("--script", options.scriptFile,
                   "Lua file, or the name of a shipped one: idle.lua, wander.lua, chase.lua, goals.lua, crown.lua, "
                   "mash.lua, storm.lua")
      ->type_name("FILE REQUIRED");
  subcommand->add_option("--count", options.count, "Number of bots")
      ->check(command::Within(1, kMaxBots))
      ->capture_default_str();
  subcommand->add_option("--ramp", words.ramp, "Time over which the bots join, evenly spread; 5, 5s, 500ms, 2m, 1h")
      ->type_name("DURATION [0]");
  subcommand->add_option("--for", words.duration, "Duration of the run, including the ramp; 0: until Ctrl-C")
      ->type_name("DURATION [0]");
  subcommand
      ->add_option("--stage", words.stages,
                   "Change the number of bots linearly to BOTS over DURATION, the last to join leave first; "
                   "repeatable, replaces --count, --ramp and --for")
      ->type_name("DURATION:BOTS")
      ->allow_extra_args(false);
  subcommand->add_option("--seed", options.seed, "Seed of the random numbers of the scripts and the link")
      ->check(command::Within(0, kMaxSeed))
      ->capture_default_str();
  subcommand
      ->add_option("--link", words.link,
                   "Simulated network conditions, such as 'loss=5%,delay=50ms,jitter=20ms' (see wobble link --help)")
      ->type_name("CONDITIONS");
  subcommand
      ->add_option("--threshold", words.thresholds,
                   "Condition on the result: a key of the summary, < <= > >= == or !=, and a number; repeatable")
      ->type_name("RULE")
      ->allow_extra_args(false);
  subcommand->add_option("--decode-share", words.decodeShare, "Share of the bots that decode and interpolate in full")
      ->type_name("A/B")
      ->capture_default_str();
  command::AddAccessOptions(*subcommand, words.access, command::Visitor::kProgram);
  subcommand->add_flag("--keep-bases", options.keepsBases,
                       "Join like players who return: keep the bases of shapes in the user's cache folder from one run "
                       "to the next, and download only what is not there");
  subcommand
      ->add_option("--rejoin", words.rejoin,
                   "How long a bot that was cut off tries to join again, as players' clients do; 0: not at all")
      ->type_name("DURATION [60s]");
  subcommand->add_option("--summary", options.summaryFile, "File for the summary as JSON")->type_name("FILE");
  subcommand->add_option("--status", words.statusEvery, "Time between status lines, 0: none (1s on a terminal, else 0)")
      ->type_name("DURATION");
  subcommand
      ->add_option("--protocol-version", options.protocolVersion, "Protocol version to claim, for tests of servers")
      ->check(command::Within(0, 65535))
      ->capture_default_str();
  subcommand->footer(
      "Exit code: 0 all thresholds hold, 99 one fails, 1 the server was lost, 2 bad usage, broken script or no "
      "server.\n"
      "Examples:\n"
      "  wobble bots 127.0.0.1:7777 --script wander.lua --count 32 --ramp 2 --for 20\n"
      "  wobble bots example.org:7777 --script my.lua --count 200 --ramp 30 --for 300 \\\n"
      "    --threshold 'disconnects==0' --threshold 'snapshot_age_ms_p99<150' --summary figures.json\n"
      "  wobble bots 127.0.0.1:7777 --script chase.lua --stage 30s:200 --stage 2m:200 --stage 10s:0\n"
      "  wobble bots 127.0.0.1:7777 --script storm.lua --count 50 --for 1m --threshold 'join_ms_p99<500'\n"
      "client/bots/LUA.md in the sources documents the scripts.");
  return subcommand;
}

// Parses the text options into `options`. Returns one line per error.
std::vector<std::string> Understand(const CLI::App& subcommand, const Words& words, LoadTestOptions& options) {
  std::vector<std::string> errors;
  std::string error;
  // Stores a parsed value, or notes the parser's error.
  const auto take = [&](const char* option, auto read, auto& target) {
    if (read) {
      target = std::move(*read);
    } else {
      errors.push_back(std::string(option) + ": " + error);
    }
  };
  if (words.address.empty()) {
    errors.emplace_back("HOST:PORT of the server is required (see wobble bots --help)");
  } else {
    take("server", command::ParseAddress(words.address, error), options.server);
  }
  if (errors.empty() &&
      !command::FindAccess(words.access, options.server, command::Visitor::kProgram, options.access, error)) {
    errors.push_back(error);
  }
  if (options.scriptFile.empty()) errors.emplace_back("--script is required (see wobble bots --help)");
  if (!words.ramp.empty()) take("--ramp", usage::ParseDuration(words.ramp, error), options.ramp);
  if (!words.duration.empty()) take("--for", usage::ParseDuration(words.duration, error), options.duration);
  if (!words.statusEvery.empty()) take("--status", usage::ParseDuration(words.statusEvery, error), options.statusEvery);
  take("--decode-share", ParseDecodeShare(words.decodeShare, error), options.decodeShare);
  if (!words.rejoin.empty()) take("--rejoin", usage::ParseDuration(words.rejoin, error), options.rejoin.patience);
  if (!words.link.empty()) take("--link", transport::ParseLinkSpec(words.link, error), options.link);
  for (const std::string& rule : words.thresholds)
    take("--threshold", ParseThreshold(rule, error), options.thresholds.emplace_back());
  for (const std::string& stage : words.stages)
    take("--stage", ParseStage(stage, error), options.stages.emplace_back());
  for (const char* other : {"--count", "--ramp", "--for"}) {
    if (words.stages.empty() || subcommand.get_option(other)->count() == 0) continue;
    errors.push_back(std::string(other) +
                     ": not together with --stage, which sets the number of bots and the duration");
  }
  const bool onlyEmpty = std::all_of(words.stages.begin(), words.stages.end(),
                                     [](const std::string& stage) { return stage.ends_with(":0"); });
  if (!words.stages.empty() && onlyEmpty)
    errors.emplace_back("--stage: no stage has bots; at least one needs 1 to " + std::to_string(kMaxBots));
  options.scriptFile = FindScriptFile(options.scriptFile);
  return errors;
}

}  // namespace

command::Command DescribeBots(CLI::App& app) {
  const auto options = std::make_shared<LoadTestOptions>();
  const auto words = std::make_shared<Words>();
  CLI::App* subcommand = AddWords(app, *options, *words);
  return {subcommand, [subcommand, options, words](const command::IsStopAsked& isStopAsked) {
            const std::vector<std::string> errors = Understand(*subcommand, *words, *options);
            if (errors.empty()) return RunLoadTest(*options, isStopAsked);
            for (const std::string& error : errors) std::fprintf(stderr, "wobble bots: %s\n", error.c_str());
            return command::kExitBadUse;
          }};
}

}  // namespace wobble::bots
