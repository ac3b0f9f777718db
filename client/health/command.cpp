// `wobble health`: asks a server's --ops or a gateway for /healthz and passes the answer on as an exit code. For health
// checks of containers, which hold no other program that could ask.
#include "client/health/command.h"

#include <httplib.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <sstream>

#include "client/command/address.h"
#include "protocol/text.h"

namespace wobble::health {
namespace {

constexpr int kPatience = 2;  // s, for the connection and for the answer
constexpr int kMostLines = 10;

// An honest answer is one line. Another program may answer on that port, so what is shown is bounded and clean.
void PrintAnswer(const std::string& body) {
  std::istringstream lines(body);
  std::string line;
  for (int count = 0; count < kMostLines && std::getline(lines, line); ++count) {
    std::printf("%s\n", protocol::MakeLine(line, protocol::kMaxShownBytes).c_str());
  }
}

int AskHealth(const std::string& words) {
  std::string error;
  const bool isPort = words.find_first_not_of("0123456789") == std::string::npos && !words.empty();
  const auto address = command::ParseAddress(isPort ? "127.0.0.1:" + words : words, error);
  if (!address) {
    std::fprintf(stderr, "wobble health: %s\n", error.c_str());
    return command::kExitBadUse;
  }
  httplib::Client client(address->host, address->port);
  client.set_connection_timeout(kPatience);
  client.set_read_timeout(kPatience);
  const httplib::Result result = client.Get("/healthz");
  if (!result) {
    std::fprintf(stderr, "wobble health: no answer from %s\n", command::Describe(*address).c_str());
    return command::kExitFailed;
  }
  PrintAnswer(result->body);
  return result->status == 200 ? command::kExitGood : command::kExitFailed;
}

}  // namespace

command::Command DescribeHealth(CLI::App& app) {
  const auto address = std::make_shared<std::string>();
  CLI::App* subcommand = app.add_subcommand("health", "Checks that a server or gateway works");
  subcommand->add_option("address", *address, "A server's --ops, or a gateway's --http")
      ->type_name("HOST:PORT or PORT REQUIRED");
  subcommand->footer(
      "Exit code: 0 it works, 1 it does not or does not answer within 2 s, 2 bad usage.\n"
      "Examples:\n"
      "  wobble health 9100               a server started with --ops 9100\n"
      "  wobble health 127.0.0.1:8080     a gateway");
  return {subcommand, [address](const command::IsStopAsked&) { return AskHealth(*address); }};
}

}  // namespace wobble::health
