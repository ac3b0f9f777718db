// What the orders share: their words, players and times.
#include "server/admin/order.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/text.h"
#include "server/admission/rank.h"

namespace wobble::admin {

using transport::Rank;

namespace {

constexpr std::uint64_t kMostSeconds = 3650ULL * 24 * 3600;

}  // namespace

std::string Order::TakeWord() {
  if (words.empty()) return "";
  std::string word = std::move(words.front());
  words.pop_front();
  return word;
}

bool Order::TakeIf(const char* word) {
  if (words.empty() || words.front() != word) return false;
  words.pop_front();
  return true;
}

std::string Order::TakeRest() {
  std::string rest;
  while (!words.empty()) rest += (rest.empty() ? "" : " ") + TakeWord();
  return protocol::MakeLine(rest, protocol::kMaxOrderBytes);
}

Answer Done(std::string line) { return {.isDone = true, .lines = {std::move(line)}}; }
Answer Refuse(std::string line) { return {.isDone = false, .lines = {std::move(line)}}; }

std::string Quote(const std::string& word) { return "\"" + protocol::MakeLine(word, 40) + "\""; }

std::string FormatEnd(std::uint64_t until) {
  if (until == 0) return "for good";
  return fmt::format("until {:%Y-%m-%d %H:%M} UTC", fmt::gmtime(static_cast<std::time_t>(until)));
}

std::optional<std::uint64_t> TakeSpan(Order& order, Answer& refusal) {
  if (order.IsAtEnd()) {
    refusal = Refuse("for: must be followed by a time such as 90s, 15m, 2h, 7d or ever");
    return {};
  }
  const std::string word = order.TakeWord();
  const auto span = ParseSpan(word);
  if (!span) refusal = Refuse("for " + protocol::MakeLine(word, 20) + ": must be such as 90s, 15m, 2h, 7d or ever");
  return span;
}

std::optional<server::Server::Player> TakePlayer(Order& order, Answer& refusal) {
  const std::string word = order.TakeWord();
  const auto client = ParseNumber<server::ClientId>(word);
  for (const auto& player : order.realm.server.ListPlayers(order.now)) {
    if (client != player.client) continue;
    if (order.issuer.rank == Rank::kOwner || player.admission.rank < order.issuer.rank) return player;
    refusal = Refuse(
        fmt::format("{} is {}, which is not below your rank", player.name, admission::NameOf(player.admission.rank)));
    return {};
  }
  if (word.empty()) {
    refusal = Refuse("name a player by number (see players)");
  } else if (client) {
    refusal = Refuse("no player has the number " + protocol::MakeLine(word, 20) + " (see players)");
  } else {
    refusal = Refuse(Quote(word) + " is no player's number (see players)");
  }
  return {};
}

std::optional<std::uint64_t> ParseSpan(const std::string& text) {
  if (text == "ever") return 0;
  if (text.empty()) return {};
  constexpr std::array kUnits{std::pair{'s', 1ULL}, std::pair{'m', 60ULL}, std::pair{'h', 3600ULL},
                              std::pair{'d', 24 * 3600ULL}};
  const auto unit =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& each) { return each.first == text.back(); });
  const auto number = ParseNumber<std::uint64_t>(text.substr(0, text.size() - 1));
  if (unit == kUnits.end() || !number || *number == 0 || *number > kMostSeconds / unit->second) return {};
  return *number * unit->second;
}

}  // namespace wobble::admin
