// Each order is a function that takes the words behind its name; the table at the end names them all, with what people
// read about them and the least rank that may give them.
#include "server/admin/orders.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <deque>
#include <sstream>
#include <utility>

#include "protocol/text.h"
#include "server/admission/rank.h"

namespace wobble::admin {

using admission::Ban;
using admission::Invite;
using protocol::wire::GoodbyeReason;
using server::ClientId;
using transport::Rank;

namespace {

constexpr std::uint64_t kBanSeconds = 24 * 3600;  // unless something else is asked for
constexpr std::size_t kMaxReasonBytes = 120;
constexpr std::uint64_t kMostSeconds = 3650ULL * 24 * 3600;

struct Order {
  Realm realm;
  Issuer issuer;
  double now = 0;
  std::deque<std::string> words = {};

  [[nodiscard]] bool IsAtEnd() const { return words.empty(); }
  // "" at the end.
  std::string TakeWord() {
    if (words.empty()) return "";
    std::string word = std::move(words.front());
    words.pop_front();
    return word;
  }
  bool TakeIf(const char* word) {
    if (words.empty() || words.front() != word) return false;
    words.pop_front();
    return true;
  }
  std::string TakeRest() {
    std::string rest;
    while (!words.empty()) rest += (rest.empty() ? "" : " ") + TakeWord();
    return protocol::MakeLine(rest, kMaxReasonBytes);
  }
};

Answer Done(std::string line) { return {.isDone = true, .lines = {std::move(line)}}; }
Answer Refuse(std::string line) { return {.isDone = false, .lines = {std::move(line)}}; }

template <class Number>
std::optional<Number> ParseNumber(const std::string& text) {
  Number number{};
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool isWhole = result == std::errc{} && end == text.data() + text.size() && !text.empty();
  return isWhole ? std::optional(number) : std::nullopt;
}

std::string FormatEnd(std::uint64_t until) {
  if (until == 0) return "for good";
  return fmt::format("until {:%Y-%m-%d %H:%M} UTC", fmt::gmtime(static_cast<std::time_t>(until)));
}

// The player that the next word names; nullopt with the reason in `refusal` when there is none, or none below the
// issuer's rank.
std::optional<server::Server::Player> TakePlayer(Order& order, Answer& refusal) {
  const std::string word = order.TakeWord();
  const auto client = ParseNumber<ClientId>(word);
  for (const auto& player : order.realm.server.ListPlayers(order.now)) {
    if (client != player.client) continue;
    if (order.issuer.rank == Rank::kOwner || player.admission.rank < order.issuer.rank) return player;
    refusal = Refuse(
        fmt::format("{} is {}, which is not below your rank", player.name, admission::NameOf(player.admission.rank)));
    return {};
  }
  refusal = Refuse(word.empty() ? "name a player by number (see players)"
                                : "no player has the number " + protocol::MakeLine(word, 20) + " (see players)");
  return {};
}

// "for 2h"; nullopt with the reason in `refusal` when the time is no time. usual: without it, s.
std::optional<std::uint64_t> TakeSpan(Order& order, std::uint64_t usual, Answer& refusal) {
  if (!order.TakeIf("for")) return usual;
  const std::string word = order.TakeWord();
  const auto span = ParseSpan(word);
  if (!span) refusal = Refuse("for " + protocol::MakeLine(word, 20) + ": must be such as 90s, 15m, 2h, 7d or ever");
  return span;
}

Answer ListPlayers(Order& order) {
  Answer answer{.isDone = true, .lines = {}};
  for (const auto& player : order.realm.server.ListPlayers(order.now)) {
    const transport::Admission& admission = player.admission;
    const bool hasAddress = admission.from.ip != transport::NetAddress{}.ip;
    answer.lines.push_back(fmt::format("{:5} {:32} {:9} {:6.0f} s  {}{}{}{}", player.client, player.name,
                                       admission::NameOf(admission.rank), player.seconds,
                                       hasAddress ? transport::FormatIp(admission.from) : "address unknown",
                                       admission.account != 0 ? fmt::format(", account {}", admission.account) : "",
                                       player.isSpectator ? ", watches" : "", player.isMuted ? ", muted" : ""));
  }
  if (answer.lines.empty()) answer.lines.emplace_back("nobody is in");
  return answer;
}

Answer ShowStatus(Order& order) {
  const server::Server& server = order.realm.server;
  return Done(fmt::format("{} in, {}, tick {}{}", server.CountPlaying(), server.IsLocked() ? "locked" : "open",
                          server.World().Tick(), server.IsProtected() ? ", builds are protected" : ""));
}

Answer Kick(Order& order) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  order.realm.server.Dismiss(player->client, GoodbyeReason::Kicked, order.TakeRest());
  return Done(player->name + " is out");
}

std::string Describe(const Ban& ban) {
  return fmt::format("{:5} {:40} {}{}{}", ban.number,
                     ban.account != 0 ? fmt::format("account:{}", ban.account) : transport::FormatIp(ban.address),
                     FormatEnd(ban.until), ban.reason.empty() ? "" : ", ", ban.reason);
}

// Adds the ban, and sends away who is banned by it.
Answer Impose(Order& order, const Ban& wanted) {
  std::string error;
  std::vector<ClientId> banned;
  const std::string line = order.realm.gate.ChangeBans([&](admission::Bans& bans, std::uint64_t unixNow) {
    Ban ban = wanted;
    if (ban.until != 0) ban.until += unixNow;
    const std::string added = Describe(bans.Add(ban, unixNow, error));
    for (const auto& player : order.realm.server.ListPlayers(order.now)) {
      const bool isBelow = order.issuer.rank == Rank::kOwner || player.admission.rank < order.issuer.rank;
      if (isBelow && player.client != order.issuer.client &&
          bans.IsBanned(player.admission.from, player.admission.account, unixNow)) {
        banned.push_back(player.client);
      }
    }
    return added;
  });
  for (const ClientId client : banned) order.realm.server.Dismiss(client, GoodbyeReason::Banned, wanted.reason);
  Answer answer = Done(line);
  answer.lines.push_back(fmt::format("{} sent away", banned.size()));
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  return answer;
}

// Of a player: the account if it has one, else the address.
Answer AddBan(Order& order) {
  Answer refusal;
  Ban ban;
  const std::string whom = order.words.empty() ? "" : order.words.front();
  constexpr const char* kAccount = "account:";
  if (const auto address = transport::ParseIp(whom)) {
    ban.address = *address;
    order.TakeWord();
  } else if (whom.rfind(kAccount, 0) == 0) {
    const auto account = ParseNumber<std::uint64_t>(whom.substr(std::string(kAccount).size()));
    if (!account || *account == 0) return Refuse("account: must be followed by a number from 1");
    ban.account = *account;
    order.TakeWord();
  } else {
    const auto player = TakePlayer(order, refusal);
    if (!player) return refusal;
    ban.account = player->admission.account;
    ban.address = player->admission.from;
    if (ban.account == 0 && ban.address.ip == transport::NetAddress{}.ip) return Refuse("its address is not known");
  }
  const auto span = TakeSpan(order, kBanSeconds, refusal);
  if (!span) return refusal;
  ban.until = *span;
  ban.reason = order.TakeRest();
  return Impose(order, ban);
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
  const std::string word = order.TakeWord();
  const auto number = ParseNumber<std::uint32_t>(word);
  std::string error;
  const bool isLifted = order.realm.gate.ChangeBans([&](admission::Bans& bans, std::uint64_t unixNow) {
    return number.has_value() && bans.Lift(*number, unixNow, error);
  });
  if (!isLifted) return Refuse("no ban has the number " + protocol::MakeLine(word, 20) + " (see bans)");
  Answer answer = Done(fmt::format("ban {} has ended", *number));
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  return answer;
}

Answer SetMuted(Order& order, bool isMuted) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  order.realm.server.SetMuted(player->client, isMuted);
  return Done(player->name + (isMuted ? " may only move" : " may act again"));
}

Answer Mute(Order& order) { return SetMuted(order, true); }
Answer Unmute(Order& order) { return SetMuted(order, false); }

Answer Lock(Order& order) {
  order.realm.server.SetLocked(true);
  return Done("locked: only moderators and owners come in");
}

Answer Unlock(Order& order) {
  order.realm.server.SetLocked(false);
  return Done("open");
}

Answer Protect(Order& order) {
  const std::string word = order.TakeWord();
  if (word != "on" && word != "off") return Refuse("protect: must be followed by on or off");
  if (!order.realm.server.SetProtected(word == "on")) return Refuse("this scene has no workshop");
  return Done(word == "on" ? "players change only what they have built themselves" : "everybody changes everything");
}

Answer ChangeRank(Order& order) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  const std::string word = order.TakeWord();
  const auto rank = admission::ParseRank(word);
  if (!rank || *rank == Rank::kWatcher) {
    return Refuse("rank " + protocol::MakeLine(word, 20) + ": must be player, moderator or owner");
  }
  order.realm.server.SetRank(player->client, *rank);
  return Done(player->name + " is " + word + " now, until it leaves");
}

Answer HandOver(Order& order) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  order.realm.server.SetRank(player->client, Rank::kOwner);
  if (order.issuer.client != 0) order.realm.server.SetRank(order.issuer.client, Rank::kModerator);
  return Done(player->name + " owns this world now, until it leaves");
}

Answer Reset(Order& order) {
  order.realm.server.ResetWorld();
  return Done("bodies, workshop and tuning are as in the scene; what is torn stays torn");
}

Answer Say(Order& order) {
  order.realm.server.Say(order.TakeRest());
  return Done("said");
}

std::string Describe(const Invite& invite) {
  return fmt::format("{:5} {:9} {}, {}", invite.number, admission::NameOf(invite.rank), FormatEnd(invite.until),
                     invite.isCounted ? fmt::format("{} {} left", invite.uses, invite.uses == 1 ? "use" : "uses")
                                      : "any number of uses");
}

Answer MakeInvite(Order& order) {
  Answer refusal;
  Invite wanted;
  if (!order.IsAtEnd() && order.words.front() != "for" && order.words.front() != "uses") {
    const std::string word = order.TakeWord();
    const auto rank = admission::ParseRank(word);
    if (!rank) return Refuse("rank " + protocol::MakeLine(word, 20) + ": must be watcher, player, moderator or owner");
    wanted.rank = *rank;
  }
  if (order.issuer.rank != Rank::kOwner && wanted.rank >= order.issuer.rank) {
    return Refuse("you may invite only below your own rank");
  }
  const auto span = TakeSpan(order, admission::kInviteSeconds, refusal);
  if (!span) return refusal;
  if (order.TakeIf("uses")) {
    const std::string word = order.TakeWord();
    const auto uses = ParseNumber<std::uint32_t>(word);
    if (!uses || *uses == 0) return Refuse("uses " + protocol::MakeLine(word, 20) + ": must be a number from 1");
    wanted.uses = *uses;
    wanted.isCounted = true;
  }
  std::string error, secret;
  const std::string line = order.realm.gate.ChangeInvites(
      [&](admission::Invites& invites, std::uint64_t unixNow, const transport::vestibule::RandomSource& random) {
        if (*span != 0) wanted.until = unixNow + *span;
        secret = invites.Make(wanted, unixNow, random, error);
        return Describe(wanted);
      });
  Answer answer = Done(line);
  answer.lines.push_back("#invite=" + secret);
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  return answer;
}

Answer ListInvites(Order& order) {
  Answer answer{.isDone = true, .lines = {}};
  order.realm.gate.ChangeInvites([&](admission::Invites& invites, std::uint64_t unixNow, const auto&) {
    for (const Invite& invite : invites.All(unixNow)) answer.lines.push_back(Describe(invite));
  });
  if (answer.lines.empty()) answer.lines.emplace_back("nobody is invited");
  return answer;
}

// Those who are in with the rank of an invite that has ended are players from now on. Whom somebody has appointed to
// more than that keeps it.
std::size_t EndRanks(Order& order, const Invite& ended) {
  std::size_t count = 0;
  for (const auto& player : order.realm.server.ListPlayers(order.now)) {
    const Rank rank = player.admission.rank;
    if (player.admission.invite != ended.number || rank <= Rank::kPlayer || rank > ended.rank) continue;
    order.realm.server.SetRank(player.client, Rank::kPlayer);
    order.realm.server.Tell(player.client, "the invite that you came with has ended; you are a player now");
    ++count;
  }
  return count;
}

Answer RevokeInvite(Order& order) {
  const std::string word = order.TakeWord();
  const auto number = ParseNumber<std::uint32_t>(word);
  std::string error;
  Invite ended;  // with the number 0: there is none
  bool isAllowed = true;
  order.realm.gate.ChangeInvites([&](admission::Invites& invites, std::uint64_t unixNow, const auto&) {
    for (const Invite& each : invites.All(unixNow)) {
      if (each.number == number) ended = each;
    }
    isAllowed = order.issuer.rank == Rank::kOwner || ended.rank < order.issuer.rank;
    if (ended.number != 0 && isAllowed) static_cast<void>(invites.Revoke(ended.number, unixNow, error));
  });
  if (ended.number == 0) return Refuse("no invite has the number " + protocol::MakeLine(word, 20) + " (see invites)");
  if (!isAllowed) return Refuse("you may revoke only invites below your own rank");
  Answer answer = Done(fmt::format("invite {} has ended", ended.number));
  if (const std::size_t count = EndRanks(order, ended); count != 0) {
    answer.lines.push_back(fmt::format("{} of those who are in {} a player now", count, count == 1 ? "is" : "are"));
  }
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  return answer;
}

Answer ShowHelp(Order& order);

struct Entry {
  const char* name;
  const char* words;
  const char* help;
  Rank least;
  Answer (*run)(Order&);
};

constexpr std::array kEntries{
    Entry{"help", "", "these lines", Rank::kPlayer, ShowHelp},
    Entry{"status", "", "how many are in, and what is locked or protected", Rank::kModerator, ShowStatus},
    Entry{"players", "", "number, name, rank, time and address of everybody who is in", Rank::kModerator, ListPlayers},
    Entry{"kick", "PLAYER [REASON]", "sends a player away, who may come back", Rank::kModerator, Kick},
    Entry{"ban", "PLAYER|ADDRESS|account:N [for TIME] [REASON]", "keeps out, for 24h unless TIME says more or less",
          Rank::kModerator, AddBan},
    Entry{"bans", "", "who is kept out", Rank::kModerator, ListBans},
    Entry{"unban", "BAN", "ends a ban by its number", Rank::kModerator, LiftBan},
    Entry{"mute", "PLAYER", "lets a player move only: no hands, no tuning, no building", Rank::kModerator, Mute},
    Entry{"unmute", "PLAYER", "takes that back", Rank::kModerator, Unmute},
    Entry{"lock", "", "lets only moderators and owners come in", Rank::kModerator, Lock},
    Entry{"unlock", "", "lets everybody come in again", Rank::kModerator, Unlock},
    Entry{"protect", "on|off", "whether players change only what they have built themselves", Rank::kModerator,
          Protect},
    Entry{"reset", "", "puts bodies, workshop and tuning back to what the scene has", Rank::kModerator, Reset},
    Entry{"say", "TEXT", "shows a line to everybody", Rank::kModerator, Say},
    Entry{"rank", "PLAYER player|moderator|owner", "appoints a player until it leaves", Rank::kOwner, ChangeRank},
    Entry{"hand-over", "PLAYER", "makes a player the owner instead of who orders it", Rank::kOwner, HandOver},
    Entry{"invite", "[RANK] [for TIME] [uses N]", "makes a link: for a player, 24h and any number of uses unless said",
          Rank::kModerator, MakeInvite},
    Entry{"invites", "", "the invites that hold", Rank::kModerator, ListInvites},
    Entry{"revoke", "INVITE", "ends an invite by its number", Rank::kModerator, RevokeInvite},
};

Answer ShowHelp(Order& order) {
  Answer answer{.isDone = true, .lines = {}};
  for (const Entry& entry : kEntries) {
    if (entry.least > order.issuer.rank) continue;
    answer.lines.push_back(
        fmt::format("{}{}{}: {}", entry.name, *entry.words == 0 ? "" : " ", entry.words, entry.help));
  }
  answer.lines.emplace_back("PLAYER is a number of `players`; TIME such as 90s, 15m, 2h, 7d or ever");
  return answer;
}

}  // namespace

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

Answer CarryOut(const Realm& realm, const Issuer& issuer, const std::string& line, double now) {
  Order order{.realm = realm, .issuer = issuer, .now = now};
  std::istringstream in(protocol::MakeLine(line, protocol::kMaxOrderBytes));
  for (std::string word; in >> word;) order.words.push_back(word);
  const std::string name = order.TakeWord();
  const auto entry =
      std::find_if(kEntries.begin(), kEntries.end(), [&](const Entry& each) { return each.name == name; });
  if (entry == kEntries.end()) return Refuse("there is no order \"" + name + "\" (see help)");
  if (issuer.rank < entry->least) {
    return Refuse(fmt::format("{} is for {}s and above; you are {}", name, admission::NameOf(entry->least),
                              admission::NameOf(issuer.rank)));
  }
  Answer answer = entry->run(order);
  // The answer may hold a secret; the order never does.
  spdlog::info("order of {}: {} ({})",
               issuer.client == 0 ? "the administration" : fmt::format("client {}", issuer.client),
               protocol::MakeLine(line, protocol::kMaxOrderBytes), answer.isDone ? "done" : answer.lines.front());
  return answer;
}

}  // namespace wobble::admin
