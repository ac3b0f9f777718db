// `wobble admin`: gives orders to a running server. Without words it reads orders from its input, a line each.
#include "client/admin/command.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "client/admin/ask.h"
#include "client/command/address.h"
#include "protocol/text.h"
#include "protocol/transport/vestibule/key_file.h"

namespace wobble::admin {
namespace {

namespace vestibule = transport::vestibule;

struct AdminWords {
  std::string socket;
  std::string http;
  std::string keyFile;
  std::vector<std::string> order;
};

// Names of players stand in answers: what is printed is clean.
bool Print(const Reply& reply) {
  std::istringstream lines(reply.text);
  for (std::string line; std::getline(lines, line);) {
    const std::string clean = protocol::MakeLine(line, 400);
    if (reply.isDone) {
      std::printf("%s\n", clean.c_str());
    } else {
      std::fprintf(stderr, "wobble admin: %s\n", clean.c_str());
    }
  }
  std::fflush(stdout);
  return reply.isDone;
}

int RunAdmin(const AdminWords& words, const command::IsStopAsked& stopAsked) {
  const auto complain = [](const std::string& error) {
    std::fprintf(stderr, "wobble admin: %s\n", error.c_str());
    return command::kExitBadUse;
  };
  if (words.socket.empty() == words.http.empty()) {
    return complain("give either --socket PATH or --http HOST:PORT (see wobble admin --help)");
  }
  std::string error, key;
  command::Address address;
  if (!words.http.empty()) {
    const bool isPort = words.http.find_first_not_of("0123456789") == std::string::npos;
    const auto parsed = command::ParseAddress(isPort ? "127.0.0.1:" + words.http : words.http, error);
    if (!parsed) return complain("--http " + error);
    address = *parsed;
    const auto file = words.keyFile.empty() ? vestibule::FindStateFile(vestibule::kOwnerKeyName)
                                            : std::filesystem::path(words.keyFile);
    if (!vestibule::InitialiseSodium()) return complain("the cryptographic library does not start");
    const auto owner = vestibule::LoadKey(file, error);
    if (!owner) return complain("--owner-key: " + error);
    key = vestibule::FormatKey(*owner);
  }
  const auto ask = [&](const std::string& order) {
    return Print(words.http.empty() ? AskSocket(words.socket, order) : AskHttp(address.host, address.port, key, order));
  };
  if (!words.order.empty()) {
    std::string order;
    for (const std::string& word : words.order) order += (order.empty() ? "" : " ") + word;
    if (order.find_first_not_of(" \t") == std::string::npos) {
      return complain("the order is empty (the order help lists them all)");
    }
    return ask(order) ? command::kExitGood : command::kExitFailed;
  }
  bool areDone = true;
  const bool isTerminal = isatty(STDIN_FILENO) == 1;
  for (std::string order; !stopAsked();) {
    if (isTerminal) std::printf("> "), std::fflush(stdout);
    if (!std::getline(std::cin, order)) break;
    if (!order.empty()) areDone = ask(order) && areDone;
  }
  return areDone ? command::kExitGood : command::kExitFailed;
}

}  // namespace

command::Command DescribeAdmin(CLI::App& app) {
  const auto words = std::make_shared<AdminWords>();
  CLI::App* subcommand = app.add_subcommand("admin", "Gives orders to a running server: kick, ban, invite and more");
  subcommand->add_option("--socket", words->socket, "The server's --admin-socket")
      ->type_name("PATH")
      ->envname("WOBBLE_ADMIN_SOCKET");
  subcommand->add_option("--http", words->http, "The server's --admin-http")->type_name("HOST:PORT or PORT");
  subcommand
      ->add_option("--owner-key", words->keyFile,
                   "For --http: the server's owner key (owner.key in the user's state folder)")
      ->type_name("FILE");
  subcommand->add_option("order", words->order, "The order and its words; without it, lines are read from the input");
  subcommand->positionals_at_end(true);
  subcommand->footer(
      "Exit code: 0 done, 1 refused or no answer, 2 bad usage.\n"
      "Examples:\n"
      "  wobble admin --socket admin.sock help\n"
      "  wobble admin --socket admin.sock players\n"
      "  wobble admin --socket admin.sock ban 7 for 2h \"cuts everything\"\n"
      "  wobble admin --socket admin.sock invite moderator for 7d uses 1");
  return {subcommand, [words](const command::IsStopAsked& stopAsked) { return RunAdmin(*words, stopAsked); }};
}

}  // namespace wobble::admin
