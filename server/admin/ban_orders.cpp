// Bans: of addresses and accounts, named by themselves or by a player who is in.
#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "server/admin/order.h"

namespace wobble::admin {

using admission::Ban;
using protocol::wire::GoodbyeReason;
using server::ClientId;
using transport::Rank;

namespace {

constexpr std::uint64_t kBanSeconds = 24 * 3600;  // unless something else is asked for
constexpr const char* kForThisRun = "holds until the server ends: it was started without --bans";

std::string Describe(const Ban& ban) {
  return fmt::format("{:5} {:40} {}{}{}", ban.number,
                     ban.account != 0 ? fmt::format("account:{}", ban.account) : transport::FormatIp(ban.address),
                     FormatEnd(ban.until), ban.reason.empty() ? "" : ", ", ban.reason);
}

// Those whom the bans keep out and who are in all the same, but those whom the issuer may not send away.
std::vector<ClientId> FindBanned(const Order& order, const admission::Bans& bans, std::uint64_t unixNow) {
  std::vector<ClientId> banned;
  for (const auto& player : order.realm.server.ListPlayers(order.now)) {
    const bool isBelow = order.issuer.rank == Rank::kOwner || player.admission.rank < order.issuer.rank;
    if (isBelow && player.client != order.issuer.client &&
        bans.IsBanned(player.admission.from, player.admission.account, unixNow)) {
      banned.push_back(player.client);
    }
  }
  return banned;
}

// Adds the ban, and sends away who is banned by it. wanted.until: s from now.
Answer Impose(Order& order, const Ban& wanted) {
  std::string error;
  std::vector<ClientId> banned;
  bool isKept = true;
  const Ban added = order.realm.gate.ChangeBans([&](admission::Bans& bans, std::uint64_t unixNow) {
    Ban ban = wanted;
    if (ban.until != 0) ban.until += unixNow;
    ban = bans.Add(ban, unixNow, error);
    banned = FindBanned(order, bans, unixNow);
    isKept = bans.HasFile();
    return ban;
  });
  const std::string why = FormatEnd(added.until) + (added.reason.empty() ? "" : ", ") + added.reason;
  for (const ClientId client : banned) order.realm.server.Dismiss(client, GoodbyeReason::Banned, why);
  Answer answer = Done(Describe(added));
  answer.lines.push_back(fmt::format("{} sent away", banned.size()));
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  if (!isKept) answer.lines.emplace_back(kForThisRun);
  return answer;
}

// "account:7", or an address. nullopt: it is neither.
std::optional<Ban> ParseSubject(const std::string& word) {
  constexpr std::string_view kAccount = "account:";
  Ban ban;
  if (word.starts_with(kAccount)) {
    ban.account = ParseNumber<std::uint64_t>(word.substr(kAccount.size())).value_or(0);
    return ban.account == 0 ? std::nullopt : std::optional(ban);
  }
  const auto address = transport::ParseIp(word);
  if (!address) return {};
  ban.address = *address;
  return ban;
}

// Of a player: the account if it has one, else the address. nullopt with the reason in `refusal`.
std::optional<Ban> TakeSubject(Order& order, Answer& refusal) {
  const std::string word = order.IsAtEnd() ? "" : order.words.front();
  if (auto ban = ParseSubject(word)) {
    order.TakeWord();
    return ban;
  }
  if (word.empty()) {
    refusal = Refuse("name a player by number (see players), an address, or account:N");
    return {};
  }
  if (!ParseNumber<ClientId>(word)) {
    refusal = Refuse(Quote(word) + " is neither a player's number (see players) nor an IP address nor account:N");
    return {};
  }
  const auto player = TakePlayer(order, refusal);
  if (!player) return {};
  Ban ban;
  ban.account = player->admission.account;
  ban.address = player->admission.from;
  const bool hasAddress = ban.address.ip != transport::NetAddress{}.ip;
  if (ban.account != 0 || (hasAddress && !ban.address.IsLoopback())) return ban;
  const std::string address = transport::FormatIp(ban.address);
  refusal = Refuse(hasAddress ? player->name +
                                    " comes from this machine itself, as do bots of this machine and browsers "
                                    "behind a gateway without a key: kick it, or ban " +
                                    address + " to keep out all of them"
                              : "its address is not known");
  return {};
}

// People write the time behind the reason as well: "7 cuts everything for 2h".
std::optional<std::uint64_t> TakeSpanAtEnd(Order& order) {
  const std::size_t count = order.words.size();
  if (count < 2 || order.words[count - 2] != "for") return {};
  const auto span = ParseSpan(order.words[count - 1]);
  if (span) order.words.resize(count - 2);
  return span;
}

}  // namespace

Answer AddBan(Order& order) {
  Answer refusal;
  auto ban = TakeSubject(order, refusal);
  if (!ban) return refusal;
  ban->until = kBanSeconds;
  if (order.TakeIf("for")) {
    const auto span = TakeSpan(order, refusal);
    if (!span) return refusal;
    ban->until = *span;
  } else if (const auto span = TakeSpanAtEnd(order)) {
    ban->until = *span;
  }
  ban->reason = order.TakeRest();
  return Impose(order, *ban);
}

Answer ListBans(Order& order) {
  Answer answer{.isDone = true, .lines = {}};
  order.realm.gate.ChangeBans([&](admission::Bans& bans, std::uint64_t unixNow) {
    for (const Ban& ban : bans.All(unixNow)) answer.lines.push_back(Describe(ban));
  });
  if (answer.lines.empty()) answer.lines.emplace_back("nobody is banned");
  return answer;
}

Answer LiftBan(Order& order) {
  if (order.IsAtEnd()) return Refuse("name a ban by its number (see bans), an address, or account:N");
  const std::string word = order.TakeWord();
  const auto number = ParseNumber<std::uint32_t>(word);
  const auto subject = ParseSubject(word);
  if (!number && !subject) return Refuse(Quote(word) + " is neither a ban's number (see bans) nor an IP address");
  std::string error;
  const bool isLifted = order.realm.gate.ChangeBans([&](admission::Bans& bans, std::uint64_t unixNow) {
    return number ? bans.Lift(*number, unixNow, error) : bans.LiftOf(*subject, unixNow, error);
  });
  if (!isLifted) return Refuse("there is no ban " + (number ? word : "of " + word) + " (see bans)");
  Answer answer = Done("ban " + (number ? word : "of " + word) + " has ended");
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  return answer;
}

}  // namespace wobble::admin
