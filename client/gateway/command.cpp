#include "client/gateway/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <memory>

#include "client/command/address.h"
#include "client/command/clock.h"
#include "client/command/world_list.h"
#include "client/gateway/addresses.h"
#include "client/gateway/gateway.h"
#include "client/gateway/origin.h"
#include "protocol/transport/vestibule/key_file.h"
#include "protocol/usage/command_line.h"

namespace wobble::gateway {
namespace {

constexpr double kMostConnections = 1000;
constexpr std::size_t kMaxNameBytes = 32;  // of a world's

// Options as text, before they are checked.
struct Words {
  std::vector<std::string> servers;
  std::string page;
  std::string gatewayKey;
  bool isCheck = false;
};

CLI::App* AddWords(CLI::App& app, GatewayOptions& options, Words& words) {
  CLI::App* subcommand =
      app.add_subcommand("gateway", "Serves the page for browsers and relays each browser to a server");
  // CLI11's required() is not used: it would be reported even when an unknown option is the fault.
  subcommand
      ->add_option("--server", words.servers,
                   "The server; repeat it for several, each with the name that the page shows")
      ->type_name("[NAME=]HOST:PORT REQUIRED");
  subcommand
      ->add_option("--recordings", options.recordings,
                   "Folder whose recordings (wobbled --record) visitors may watch; none if not given")
      ->type_name("FOLDER");
  subcommand->add_option("--http", options.port, "TCP port that browsers open; 0: a free one")
      ->check(command::Within(0, 65535))
      ->capture_default_str();
  subcommand->add_option("--bind", options.bindAddress, "Address of this machine to listen at; 0.0.0.0: all of them")
      ->capture_default_str();
  subcommand->add_option("--page", words.page, "Folder of the page; default: 'page' beside this program")
      ->type_name("DIR");
  subcommand->add_option("--max-connections", options.maxConnections, "The most browsers that play at once")
      ->check(command::Within(1, kMostConnections))
      ->capture_default_str();
  subcommand
      ->add_option("--max-per-address", options.maxPerAddress,
                   "The most of one IP address, or of one /64 of IPv6; 0: as many as --max-connections")
      ->check(command::Within(0, kMostConnections))
      ->capture_default_str();
  subcommand
      ->add_option("--trusted-proxy", options.proxies,
                   "Proxy whose X-Forwarded-For header says a browser's address; repeatable")
      ->type_name("ADDRESS");
  subcommand
      ->add_option("--gateway-key", words.gatewayKey,
                   "File of the key that the server was given by --gateway-key; it then counts and bans the browsers' "
                   "addresses instead of this gateway's")
      ->type_name("FILE");
  subcommand
      ->add_option("--origin", options.origins, "Origin whose pages may play here besides this gateway's; repeatable")
      ->type_name("URL");
  subcommand
      ->add_option(
          "--tls-cert", options.tls.certificate,
          "Certificate in PEM, with those that vouch for it behind it: the page is then https. Read again when "
          "it changes")
      ->type_name("FILE");
  subcommand->add_option("--tls-key", options.tls.key, "Its key in PEM, without a passphrase")->type_name("FILE");
  subcommand
      ->add_option(
          "--list", options.list,
          "List of worlds elsewhere in JSON, for the page and for everybody at /worlds.json; read again when it "
          "changes")
      ->type_name("FILE");
  usage::AddDuration(*subcommand, "--status", options.statusEvery, "Time between status lines on stdout; 0: none");
  subcommand->add_flag("--check", words.isCheck, "Only name every mistake in the options, exit code 2, or none, 0");
  subcommand->footer(
      "Without --tls-cert the gateway speaks plain HTTP. Behind a proxy: --bind 127.0.0.1 and --trusted-proxy with\n"
      "the proxy's address; let the proxy pass on the Host header and WebSockets at /play. Of a proxy that is not\n"
      "named all browsers count as one address.\n"
      "Exit code: 0 ended on request, 2 bad usage, no page, port in use or unknown host.\n"
      "Examples:\n"
      "  wobble gateway --server 127.0.0.1:7777\n"
      "  wobble gateway --server arena=127.0.0.1:7777 --server sumo=127.0.0.1:7778\n"
      "  wobble gateway --server 127.0.0.1:7777 --recordings matches\n"
      "  wobble gateway --server 127.0.0.1:7777 --http 80 --max-per-address 4\n"
      "  wobble gateway --server 127.0.0.1:7777 --bind 127.0.0.1 --trusted-proxy 127.0.0.1\n"
      "  wobble gateway --server 127.0.0.1:7777 --http 8443 --tls-cert fullchain.pem --tls-key privkey.pem\n"
      "  wobble gateway --server 127.0.0.1:7777 --origin https://friends.example.org");
  return subcommand;
}

bool IsName(const std::string& text) {
  const auto isGood = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !text.empty() && text.size() <= kMaxNameBytes && std::all_of(text.begin(), text.end(), isGood);
}

// False with one line in `error`.
bool ReadWorlds(const std::vector<std::string>& words, std::vector<World>& worlds, std::string& error) {
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    World world;
    if (sign != std::string::npos) world.name = word.substr(0, sign);
    const auto isSame = [&](const World& other) { return other.name == world.name; };
    if ((sign != std::string::npos || words.size() > 1) && !IsName(world.name)) {
      error = "--server: '" + word + "' needs a name of letters, digits, - and _, at most 32, before its address";
    } else if (std::any_of(worlds.begin(), worlds.end(), isSame)) {
      error = "--server: '" + world.name + "' names two servers";
    } else if (const auto address = command::ParseAddress(word.substr(sign + 1), error)) {
      world.server = *address;
      worlds.push_back(std::move(world));
      continue;
    } else {
      error = "--server: " + error;
    }
    return false;
  }
  if (worlds.empty()) error = "--server HOST:PORT is required (see wobble gateway --help)";
  return !worlds.empty();
}

// False with one line in `error`.
bool Understand(const Words& words, GatewayOptions& options, std::string& error) {
  if (!ReadWorlds(words.servers, options.worlds, error)) return false;
  std::error_code ignored;
  if (!options.recordings.empty() && !std::filesystem::is_directory(options.recordings, ignored)) {
    error = "--recordings: '" + options.recordings + "' is no folder";
    return false;
  }
  if (SpellAddress(options.bindAddress).empty()) {
    error = "--bind: '" + options.bindAddress + "' is no IP address";
    return false;
  }
  if (!words.gatewayKey.empty()) {
    options.gatewayKey = transport::vestibule::LoadKey(words.gatewayKey, error);
    if (!options.gatewayKey) {
      error = "--gateway-key: " + error;
      return false;
    }
  }
  for (std::string& proxy : options.proxies) {
    const std::string spelt = SpellAddress(proxy);
    if (spelt.empty()) {
      error = "--trusted-proxy: '" + proxy + "' is no IP address";
      return false;
    }
    proxy = spelt;
  }
  const auto wrong = std::find_if_not(options.origins.begin(), options.origins.end(), IsOrigin);
  if (wrong != options.origins.end()) {
    error = "--origin: '" + *wrong + "' is no http://HOST[:PORT] or https://HOST[:PORT]";
    return false;
  }
  if (options.tls.certificate.empty() != options.tls.key.empty()) {
    error = "--tls-cert and --tls-key go together";
    return false;
  }
  std::string warning;  // is given at the start
  if (options.tls.IsWanted() && LoadTls(options.tls, std::time(nullptr), error, warning) == nullptr) return false;
  if (!options.list.empty() && !command::LoadWorldList(options.list, error)) {
    error = "--list: " + error;
    return false;
  }
  if (options.maxPerAddress == 0) options.maxPerAddress = options.maxConnections;
  return true;
}

}  // namespace

std::filesystem::path FindPageFolder() { return command::FindShipped("page"); }

command::Command DescribeGateway(CLI::App& app) {
  const auto options = std::make_shared<GatewayOptions>();
  const auto words = std::make_shared<Words>();
  CLI::App* subcommand = AddWords(app, *options, *words);
  return {subcommand,
          [subcommand, options, words](const command::IsStopAsked& isStopAsked) {
            std::string error;
            std::optional<Page> page;
            if (Understand(*words, *options, error)) {
              page = LoadPage(words->page.empty() ? FindPageFolder().string() : words->page, error);
            }
            if (page) return words->isCheck ? command::kExitGood : RunGateway(*options, *page, isStopAsked);
            std::fprintf(stderr, "wobble gateway: %s\n", usage::NameVariables(*subcommand, error).c_str());
            return command::kExitBadUse;
          },
          true};
}

}  // namespace wobble::gateway
