#include "client/play/command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "client/bots/options.h"
#include "client/command/exit_codes.h"
#include "client/gateway/command.h"
#include "client/play/play.h"
#include "protocol/usage/command_line.h"

namespace wobble::play {

command::Command DescribePlay(CLI::App& app) {
  const auto options = std::make_shared<PlayOptions>();
  const auto http = std::make_shared<std::uint16_t>(*options->http);
  CLI::App* subcommand =
      app.add_subcommand("play", "Starts worlds, a page to play them in and bots, and ends them together");
  usage::AddDuration(*subcommand, "--for", options->duration, "How long to run; 0: until Ctrl-C");
  subcommand
      ->add_option("--port", options->port,
                   "UDP port of the first world's server, the others have the next ones; 0: free ones, printed at "
                   "the start, also for the page unless --http is given")
      ->check(command::Within(0, 65535))
      ->capture_default_str();
  subcommand->add_option("--http", *http, "TCP port of the page for browsers; 0: none")
      ->check(command::Within(0, 65535))
      ->capture_default_str();
  subcommand->add_option("--page", options->page, "Folder of the page; default: 'page' beside this program")
      ->type_name("DIR");
  subcommand
      ->add_option("--bots", options->bots,
                   "Bots in the first world: they play where it is a game, and wander elsewhere")
      ->check(command::Within(0, bots::kMaxBots))
      ->capture_default_str();
  subcommand
      ->add_option("--scene", options->scenes, "A shipped scene's name or a scene file; repeat it for several worlds")
      ->capture_default_str();
  subcommand
      ->add_option("--record", options->recordings,
                   "Record all worlds in this folder, and let visitors of the page watch what is in it; 'recordings' "
                   "if none is named")
      ->type_name("[FOLDER]")
      ->expected(0, 1)
      ->default_str("recordings");
  subcommand
      ->add_option("--state", options->state,
                   "Keep the worlds in this folder, so that the next run goes on from them; else a world goes on after "
                   "its server died, but ends with this run")
      ->type_name("FOLDER");
  subcommand->footer(
      "A server, gateway or bots that die are started again, and the others go on.\n"
      "Exit code: 0 nothing failed (what died and came back has not), 1 something did, 2 a server or the gateway "
      "cannot\n"
      "start with these options.\n"
      "Examples:\n"
      "  wobble play\n"
      "  wobble play --scene sumo\n"
      "  wobble play --record\n"
      "  wobble play --for 20 --bots 12 --port 7801 --http 8081");
  return {subcommand,
          [subcommand, options, http](const command::IsStopAsked& isStopAsked) {
            options->programFolder = command::FindProgramFolder();
            if (options->port + options->scenes.size() > 65536) {
              const std::string what = "--port " + std::to_string(options->port) + ": " +
                                       std::to_string(options->scenes.size()) +
                                       " worlds need as many ports up to 65535";
              std::fprintf(stderr, "wobble play: %s\n", usage::NameVariables(*subcommand, what).c_str());
              return command::kExitBadUse;
            }
            if (options->port == 0 && subcommand->get_option("--http")->count() == 0) {
              options->http = 0;
            } else if (*http != 0) {
              options->http = *http;
            } else {
              options->http.reset();
            }
            if (options->page.empty()) options->page = gateway::FindPageFolder();
            return RunPlay(*options, isStopAsked);
          },
          true};
}

}  // namespace wobble::play
