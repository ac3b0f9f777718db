#include "client/web/command.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "client/tool/address.h"
#include "client/tool/clock.h"
#include "client/web/gateway.h"
#include "client/web/origin.h"

namespace wobble::web {
namespace {

constexpr double kMostConnections = 1000;

// What the command line says before it is understood.
struct Words {
  std::string server;
  std::string page;
};

CLI::App* AddWords(CLI::App& app, GatewayOptions& options, Words& words) {
  CLI::App* command =
      app.add_subcommand("gateway", "Serves the page that browsers play in, and relays them to a server");
  // Not required() of CLI11: it would complain of that even when an unknown option is the fault.
  command->add_option("--server", words.server, "The server")->type_name("HOST:PORT REQUIRED");
  command->add_option("--http", options.port, "TCP port that browsers open; 0: any that is free")
      ->check(tool::Within(0, 65535))
      ->capture_default_str();
  command->add_option("--bind", options.bindAddress, "Address of this machine to be reached at; 0.0.0.0: any of them")
      ->capture_default_str();
  command->add_option("--page", words.page, "Folder of the page; default: 'page' beside this program")
      ->type_name("DIR");
  command->add_option("--max-connections", options.maxConnections, "Browsers that play at once")
      ->check(tool::Within(1, kMostConnections))
      ->capture_default_str();
  command
      ->add_option("--max-per-address", options.maxPerAddress,
                   "Of one IP address, or of 64 bits of IPv6; 0: as many as --max-connections")
      ->check(tool::Within(0, kMostConnections))
      ->capture_default_str();
  command->add_option("--origin", options.origins, "Whose pages may play here beside this one's; may be given often")
      ->type_name("URL");
  command->add_option("--status", options.statusEvery, "Seconds between status lines on stdout; 0: none")
      ->check(tool::Within(0, tool::kMaxDuration))
      ->capture_default_str();
  command->footer(
      "Behind a proxy all browsers have the proxy's address: leave --max-per-address alone, let it pass on the Host\n"
      "header and WebSockets at /play, and have --bind 127.0.0.1. The gateway speaks plain HTTP.\n"
      "Exit code: 0 told to end, 2 bad usage, no page, port in use or unknown host.\n"
      "Examples:\n"
      "  wobble gateway --server 127.0.0.1:7777\n"
      "  wobble gateway --server 127.0.0.1:7777 --http 80 --max-per-address 4\n"
      "  wobble gateway --server 127.0.0.1:7777 --bind 127.0.0.1 --origin https://friends.example.org");
  return command;
}

bool IsAddress(const std::string& text) {
  in6_addr bytes{};
  return inet_pton(AF_INET, text.c_str(), &bytes) == 1 || inet_pton(AF_INET6, text.c_str(), &bytes) == 1;
}

// False with one line in `error`.
bool Understand(const Words& words, GatewayOptions& options, std::string& error) {
  if (words.server.empty()) {
    error = "--server HOST:PORT is required (see wobble gateway --help)";
    return false;
  }
  const auto address = tool::ParseAddress(words.server, error);
  if (!address) {
    error = "--server: " + error;
    return false;
  }
  options.server = *address;
  if (!IsAddress(options.bindAddress)) {
    error = "--bind: '" + options.bindAddress + "' is no IP address";
    return false;
  }
  const auto wrong = std::find_if_not(options.origins.begin(), options.origins.end(), IsOrigin);
  if (wrong != options.origins.end()) {
    error = "--origin: '" + *wrong + "' is no http://HOST[:PORT] or https://HOST[:PORT]";
    return false;
  }
  if (options.maxPerAddress == 0) options.maxPerAddress = options.maxConnections;
  return true;
}

int Complain(const std::string& error) {
  std::fprintf(stderr, "wobble gateway: %s\n", error.c_str());
  return tool::kExitBadUse;
}

}  // namespace

std::filesystem::path FindPageFolder() { return tool::FindProgramFolder() / "page"; }

tool::Command DescribeGateway(CLI::App& app) {
  const auto options = std::make_shared<GatewayOptions>();
  const auto words = std::make_shared<Words>();
  CLI::App* command = AddWords(app, *options, *words);
  return {command, [options, words](const tool::IsStopAsked& isStopAsked) {
            std::string error;
            if (!Understand(*words, *options, error)) return Complain(error);
            const auto page = LoadPage(words->page.empty() ? FindPageFolder().string() : words->page, error);
            return page ? RunGateway(*options, *page, isStopAsked) : Complain(error);
          }};
}

}  // namespace wobble::web
