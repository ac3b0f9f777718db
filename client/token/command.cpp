// `wobble token`: makes connect tokens with the key that a server was given by --token-key. A matchmaker calls it, or
// makes the same bytes itself (STANDARD.md).
#include "client/token/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <string>

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
  Rank rank = Rank::kPlayer;
  std::uint64_t account = 0;
  unsigned seconds = static_cast<unsigned>(vestibule::kMaxTokenSeconds);
  unsigned count = 1;
};

int Complain(const std::string& error) {
  std::fprintf(stderr, "wobble token: %s\n", error.c_str());
  return command::kExitBadUse;
}

int MakeTokens(const TokenWords& words) {
  std::string error;
  if (!vestibule::InitialiseSodium()) return Complain("the cryptographic library does not start");
  const auto key = vestibule::LoadKey(words.keyFile, error);
  if (!key) return Complain("--key: " + error);
  vestibule::Token token;
  if (!words.serverKey.empty()) {
    const auto server = vestibule::ParseKey(words.serverKey);
    if (!server) return Complain("--server-key: '" + words.serverKey + "' must be 64 hexadecimal digits");
    token.server = *server;
  }
  if (words.name.size() > protocol::kMaxNameBytes) {
    return Complain("--name: must have at most " + std::to_string(protocol::kMaxNameBytes) + " bytes");
  }
  std::copy(words.name.begin(), words.name.end(), token.admission.name.begin());
  token.admission.rank = words.rank;
  token.admission.account = words.account;
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
  static const std::map<std::string, Rank> kRanks{
      {"watcher", Rank::kWatcher}, {"player", Rank::kPlayer}, {"moderator", Rank::kModerator}, {"owner", Rank::kOwner}};
  CLI::App* subcommand = app.add_subcommand("token", "Makes connect tokens for a server that wants them");
  subcommand->add_option("--key", words->keyFile, "The file that the server was given by --token-key")
      ->type_name("FILE")
      ->required();
  subcommand->add_option("--name", words->name, "The player's name; the player's own choice if not given");
  subcommand->add_option("--account", words->account,
                         "Who the player is for you: bans of a player hold for it; 0: nobody");
  subcommand->add_option("--rank", words->rank, "watcher, player, moderator or owner")
      ->transform(CLI::CheckedTransformer(kRanks))
      ->type_name("RANK")
      ->default_str("player");
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
