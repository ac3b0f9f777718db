#include "client/play/command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "client/bots/options.h"
#include "client/command/clock.h"
#include "client/command/exit_codes.h"
#include "client/gateway/command.h"
#include "client/play/play.h"

namespace wobble::play {

command::Command DescribePlay(CLI::App& app) {
  const auto options = std::make_shared<PlayOptions>();
  const auto http = std::make_shared<std::uint16_t>(*options->http);
  CLI::App* subcommand =
      app.add_subcommand("play", "Starts worlds, a page to play them in and bots, and ends them together");
  subcommand->add_option("--for", options->duration, "Seconds to run; 0: until Ctrl-C")
      ->check(command::Within(0, command::kMaxDuration))
      ->capture_default_str();
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
  subcommand->add_option("--bots", options->bots, "Bots that wander in the first world")
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
  subcommand->footer(
      "Exit code: 0 nothing failed, 1 something did, 2 server or gateway cannot start with these options.\n"
      "Examples:\n"
      "  wobble play\n"
      "  wobble play --scene sumo\n"
      "  wobble play --record\n"
      "  wobble play --for 20 --bots 12 --port 7801 --http 8081");
  return {subcommand, [subcommand, options, http](const command::IsStopAsked& isStopAsked) {
            options->programFolder = command::FindProgramFolder();
            if (options->port + options->scenes.size() > 65536) {
              std::fprintf(stderr, "wobble play: --port %u: %zu worlds need as many ports up to 65535\n", options->port,
                           options->scenes.size());
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
          }};
}

}  // namespace wobble::play
