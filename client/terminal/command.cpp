#include "client/terminal/command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "client/command/access.h"
#include "client/command/clock.h"
#include "client/terminal/film.h"
#include "client/terminal/watch.h"
#include "protocol/limits.h"
#include "protocol/usage/command_line.h"

namespace wobble::terminal {
namespace {

constexpr double kMaxFps = 60;

// Options as text, before they are parsed.
struct Words {
  command::Access access;
  std::string address;
  std::string colours = "auto";
};

CLI::App* AddWords(CLI::App& app, WatchOptions& options, Words& words) {
  CLI::App* subcommand =
      app.add_subcommand("watch", "Shows a server's world in this terminal, with keys to play in it, or a recording");
  // CLI11's required() is not used: it reports the missing address even when an unknown option is the fault.
  subcommand->add_option("server", words.address, "The server, or a recording of one (wobbled --record)")
      ->type_name("HOST:PORT|FILE REQUIRED");
  subcommand->add_option("--name", options.name, "Name shown to other players")->capture_default_str();
  subcommand->add_flag("--spectate", options.spectate, "Watch without a body");
  command::AddAccessOptions(*subcommand, words.access, command::Visitor::kPerson);
  subcommand->add_option("--fps", options.fps, "Pictures per second at most; fewer on a slow line")
      ->check(command::Within(1, kMaxFps))
      ->capture_default_str();
  subcommand->add_option("--colours", words.colours, "auto (by COLORTERM and TERM), true (16 million) or 256")
      ->check(CLI::IsMember({"auto", "true", "256"}))
      ->capture_default_str();
  usage::AddDuration(*subcommand, "--for", options.duration, "How long to run; 0: until Q");
  usage::AddDuration(*subcommand, "--rejoin", options.rejoin.patience,
                     "How long it tries to join again when the connection is lost; 0: not at all");
  subcommand->add_option("--capture", options.captureFile, "File for the last picture, as SVG")->type_name("FILE");
  std::string filmKeys;
  for (const std::string& each : DescribeFilmKeys()) filmKeys += "  " + each + "\n";
  subcommand->footer(
      "Keys: W A S D or arrows move, space jumps, E or P puffs up, F stiffens, X releases all keys.\n"
      "If the scene allows it: G grabs and releases, V pushes, T cuts; 1 2 softer, stiffer, 3 4 slower, faster,\n"
      "5 skips one second, 6 7 tilt gravity.\n"
      "Enter begins a line to all and sends it, Esc gives it up; /vote restart and the like are orders.\n"
      "Y says that you are ready, before a match.\n"
      "C camera (follow, circle, stand), J L or [ ] turn, I K tilt, + - zoom; ? lists the keys; Q, Esc, Ctrl-C quit.\n"
      "Who has no body, as in a recording, follows one player after the other with B.\n"
      "Keys of a recording:\n" +
      filmKeys +
      "Most terminals do not report key releases: a tap counts for half a second, a held key while it repeats.\n"
      "Exit code: 0 ended by the user, 1 connection lost, 2 bad usage, no terminal or no server.\n"
      "Examples:\n"
      "  wobble watch 127.0.0.1:7777\n"
      "  wobble watch matches/arena-20261124-180000.wobrec\n"
      "  wobble watch example.org:7777 --name mira --password-file door.txt --fps 20\n"
      "  wobble watch 127.0.0.1:7777 --spectate --for 10 --capture picture.svg");
  return subcommand;
}

bool IsRecording(const std::string& address) { return address.ends_with(".wobrec"); }

// On failure false, with one line in `error`.
bool Understand(const Words& words, WatchOptions& options, std::string& error) {
  if (words.address.empty()) {
    error = "HOST:PORT of the server is required (see wobble watch --help)";
    return false;
  }
  std::error_code ignored;
  if (std::filesystem::is_directory(words.address, ignored)) {
    error = "'" + words.address + "' is a folder: must be a recording in it, as wobbled --list-recordings tells";
    return false;
  }
  const auto address = command::ParseAddress(words.address, error);
  if (!address) {
    error = "server: " + error;
    return false;
  }
  if (options.name.size() > protocol::kMaxNameBytes) {
    error = "--name: '" + options.name + "' is " + std::to_string(options.name.size()) + " bytes long; at most " +
            std::to_string(protocol::kMaxNameBytes) + " are allowed";
    return false;
  }
  options.server = *address;
  // Two that are cut off at once have begun at different moments.
  options.rejoin.seed = static_cast<std::uint64_t>(command::ReadClock() * 1e9);
  if (!command::FindAccess(words.access, options.server, command::Visitor::kPerson, options.access, error))
    return false;
  if (words.colours == "true") options.palette = Palette::kTruecolour;
  if (words.colours == "256") options.palette = Palette::k256;
  return true;
}

}  // namespace

command::Command DescribeWatch(CLI::App& app) {
  const auto options = std::make_shared<WatchOptions>();
  const auto words = std::make_shared<Words>();
  CLI::App* subcommand = AddWords(app, *options, *words);
  return {subcommand, [options, words](const command::IsStopAsked& isStopAsked) {
            std::string error;
            std::unique_ptr<FilmServer> film;
            if (IsRecording(words->address)) {
              film = FilmServer::Start(words->address, error);
              options->spectate = true;
              words->address = film != nullptr ? command::Describe(film->Address()) : "";
            }
            const bool isThere = error.empty() && Understand(*words, *options, error);
            if (isThere) return RunWatch(*options, isStopAsked);
            std::fprintf(stderr, "wobble watch: %s\n", error.c_str());
            return command::kExitBadUse;
          }};
}

}  // namespace wobble::terminal
