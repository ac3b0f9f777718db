// `wobble token`: makes connect tokens with the key that a server was given by --token-key. A matchmaker calls it, or
// makes the same bytes itself (STANDARD.md).
#include "client/token/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "protocol/limits.h"
#include "protocol/transport/vestibule/key_file.h"
#include "protocol/transport/vestibule/token.h"

namespace wobble::token {
namespace {

namespace vestibule = transport::vestibule;
using transport::Rank;

struct TokenWords {
  std::string keyFile;
  std::string name;
  std::string serverKey;
  std::string rank = "player";
  std::string account = "0";
  unsigned seconds = static_cast<unsigned>(vestibule::kMaxTokenSeconds);
  unsigned count = 1;
};

int Complain(const std::string& error) {
  std::fprintf(stderr, "wobble token: %s\n", error.c_str());
  return command::kExitBadUse;
}

constexpr std::array kRanks{std::pair{"watcher", Rank::kWatcher}, std::pair{"player", Rank::kPlayer},
                            std::pair{"moderator", Rank::kModerator}, std::pair{"owner", Rank::kOwner}};

// False with one line in `error`.
bool Understand(const TokenWords& words, transport::Admission& admission, std::string& error) {
  if (words.name.size() > protocol::kMaxNameBytes) {
    error = "--name: must have at most " + std::to_string(protocol::kMaxNameBytes) + " bytes";
    return false;
  }
  std::copy(words.name.begin(), words.name.end(), admission.name.begin());
  const auto rank =
      std::find_if(kRanks.begin(), kRanks.end(), [&](const auto& each) { return words.rank == each.first; });
  if (rank == kRanks.end()) {
    error = "--rank: '" + words.rank + "' must be watcher, player, moderator or owner";
    return false;
  }
  admission.rank = rank->second;
  // CLI11 takes -1 for the largest number.
  const char* end = words.account.data() + words.account.size();
  const auto [stop, result] = std::from_chars(words.account.data(), end, admission.account);
  if (result == std::errc{} && stop == end) return true;
  error = "--account: '" + words.account + "' must be a number from 0 to 18446744073709551615";
  return false;
}

int MakeTokens(const TokenWords& words) {
  std::string error;
  vestibule::Token token;
  if (!Understand(words, token.admission, error)) return Complain(error);
  if (!vestibule::InitialiseSodium()) return Complain("the cryptographic library does not start");
  const auto key = vestibule::LoadKey(words.keyFile, error);
  if (!key) return Complain("--key: " + error);
  if (!words.serverKey.empty()) {
    const auto server = vestibule::ParseKey(words.serverKey);
    if (!server) return Complain("--server-key: '" + words.serverKey + "' must be 64 hexadecimal digits");
    token.server = *server;
  }
  token.issued = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count());
  token.expires = token.issued + words.seconds;
  for (unsigned i = 0; i < words.count; ++i) {
    vestibule::FillRandomly(token.number);
    const auto bytes = vestibule::SealToken(vestibule::TokenKind::kConnect, token, *key, vestibule::FillRandomly);
    std::printf("%s\n", vestibule::FormatSecret(bytes).c_str());
  }
  return command::kExitGood;
}

}  // namespace

command::Command DescribeToken(CLI::App& app) {
  const auto words = std::make_shared<TokenWords>();
  CLI::App* subcommand = app.add_subcommand("token", "Makes connect tokens for a server that wants them");
  subcommand->add_option("--key", words->keyFile, "The file that the server was given by --token-key")
      ->type_name("FILE")
      ->required();
  subcommand->add_option("--name", words->name, "The player's name; the player's own choice if not given");
  subcommand
      ->add_option("--account", words->account, "Who the player is for you: bans of a player hold for it; 0: nobody")
      ->type_name("NUMBER")
      ->capture_default_str();
  subcommand->add_option("--rank", words->rank, "watcher, player, moderator or owner")
      ->type_name("RANK")
      ->capture_default_str();
  subcommand
      ->add_option("--server-key", words->serverKey, "The server that it is for; any with the token key if not given")
      ->type_name("KEY");
  subcommand->add_option("--seconds", words->seconds, "How long it may be shown")
      ->check(command::Within(1, vestibule::kMaxTokenSeconds))
      ->capture_default_str();
  subcommand->add_option("--count", words->count, "How many, one a line")
      ->check(command::Within(1, 100000))
      ->capture_default_str();
  subcommand->footer(
      "A token lets in once. It is good for 30 s at most; the clocks of both machines must agree to 5 s.\n"
      "Examples:\n"
      "  wobbled --token-key token.key                                  the server, which makes the key\n"
      "  wobble token --key token.key --name Ada --account 7 > ada.txt  then: wobble watch --token-file ada.txt");
  return {subcommand, [words](const command::IsStopAsked&) { return MakeTokens(*words); }};
}

}  // namespace wobble::token
