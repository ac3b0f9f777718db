#include "client/bots/command.h"

#include <cstdio>
#include <memory>

#include "client/bots/load_test.h"

namespace wobble::bots {
namespace {

// A script that lies nowhere at hand but has the bare name of a shipped one is that one.
std::string FindScript(const std::string& name) {
  const auto shipped = tool::FindProgramFolder() / "scripts" / name;
  std::error_code error;
  const bool bare = name.find('/') == std::string::npos;
  return bare && !std::filesystem::exists(name, error) && std::filesystem::exists(shipped, error) ? shipped.string()
                                                                                                  : name;
}

// What the command line says before it is understood.
struct Words {
  std::string address;
  std::string decodeShare = "1/32";
  std::vector<std::string> thresholds;
  std::string link;
  double statusEvery = -1;
};

CLI::App* AddWords(CLI::App& app, LoadTestOptions& options, Words& words) {
  CLI::App* command =
      app.add_subcommand("bots", "Runs scripted players against a server and measures how they are served");
  // Not required() of CLI11: it would complain of that even when an unknown option is the fault.
  command->add_option("server", words.address, "The server")->type_name("HOST:PORT REQUIRED");
  command->add_option("--script", options.scriptFile, "Lua file, or the name of a shipped one: idle.lua, wander.lua")
      ->type_name("FILE REQUIRED");
  command->add_option("--count", options.count, "Bots")->check(tool::Within(1, kMaxBots))->capture_default_str();
  command->add_option("--ramp", options.ramp, "Seconds over which they join")
      ->check(tool::Within(0, kMaxDuration))
      ->capture_default_str();
  command->add_option("--for", options.duration, "Seconds to run, the ramp included; 0: until Ctrl-C")
      ->check(tool::Within(0, kMaxDuration))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Of all that the scripts and the link draw by chance")
      ->capture_default_str();
  command
      ->add_option("--link", words.link,
                   "A bad network in between, such as 'loss=5%,delay=50ms,jitter=20ms' (see wobble link --help)")
      ->type_name("CONDITIONS");
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
      ->check(tool::Within(0, kMaxDuration));
  command->add_option("--protocol-version", options.protocolVersion, "For testing servers: the version to claim")
      ->check(tool::Within(0, 65535))
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
bool Understand(const Words& words, LoadTestOptions& options, std::string& error) {
  const auto blame = [&error](const char* option) {
    error = std::string(option) + ": " + error;
    return false;
  };
  if (words.address.empty() || options.scriptFile.empty()) {
    error = words.address.empty() ? "HOST:PORT of the server is required (see wobble bots --help)"
                                  : "--script is required (see wobble bots --help)";
    return false;
  }
  const auto address = tool::ParseAddress(words.address, error);
  if (!address) return blame("server");
  const auto share = ParseDecodeShare(words.decodeShare, error);
  if (!share) return blame("--decode-share");
  if (!words.link.empty()) {
    options.link = transport::ParseLinkSpec(words.link, error);
    if (!options.link) return blame("--link");
  }
  for (const std::string& rule : words.thresholds) {
    const auto threshold = ParseThreshold(rule, error);
    if (!threshold) return blame("--threshold");
    options.thresholds.push_back(*threshold);
  }
  options.server = *address;
  options.decodeShare = *share;
  options.scriptFile = FindScript(options.scriptFile);
  if (words.statusEvery >= 0) options.statusEvery = words.statusEvery;
  return true;
}

}  // namespace

tool::Command DescribeBots(CLI::App& app) {
  const auto options = std::make_shared<LoadTestOptions>();
  const auto words = std::make_shared<Words>();
  CLI::App* command = AddWords(app, *options, *words);
  return {command, [options, words](const tool::IsStopAsked& isStopAsked) {
            std::string error;
            if (Understand(*words, *options, error)) return RunLoadTest(*options, isStopAsked);
            std::fprintf(stderr, "wobble bots: %s\n", error.c_str());
            return tool::kExitBadUse;
          }};
}

}  // namespace wobble::bots
