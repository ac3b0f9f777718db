// Invites: made, listed, and revoked together with the ranks that they gave.
#include <fmt/format.h>

#include <string>

#include "server/admin/order.h"
#include "server/admission/rank.h"

namespace wobble::admin {

using admission::Invite;
using transport::Rank;

namespace {

std::string Describe(const Invite& invite) {
  return fmt::format("{:5} {:9} {}, {}", invite.number, admission::NameOf(invite.rank), FormatEnd(invite.until),
                     invite.isCounted ? fmt::format("{} {} left", invite.uses, invite.uses == 1 ? "use" : "uses")
                                      : "any number of uses");
}

// "[RANK] [for TIME] [uses N]", the last two in any order. False with the reason in `refusal`.
bool TakeInvite(Order& order, Invite& wanted, std::uint64_t& seconds, Answer& refusal) {
  bool hasRank = false, hasSpan = false;
  while (!order.IsAtEnd()) {
    if (!hasSpan && order.TakeIf("for")) {
      const auto span = TakeSpan(order, refusal);
      if (!span) return false;
      hasSpan = true;
      seconds = *span;
    } else if (!wanted.isCounted && order.TakeIf("uses")) {
      const std::string word = order.TakeWord();
      const auto uses = ParseNumber<std::uint32_t>(word);
      if (!uses || *uses == 0) return refusal = Refuse("uses " + Quote(word) + ": must be a number from 1"), false;
      wanted.uses = *uses;
      wanted.isCounted = true;
    } else {
      const std::string word = order.TakeWord();
      const auto rank = admission::ParseRank(word);
      if (!rank || hasRank) {
        refusal =
            Refuse(Quote(word) + " cannot stand here: an invite takes [RANK] [for TIME] [uses N], each once; RANK " +
                   "must be watcher, player, moderator or owner");
        return false;
      }
      hasRank = true;
      wanted.rank = *rank;
    }
  }
  return true;
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

}  // namespace

Answer MakeInvite(Order& order) {
  Answer refusal;
  Invite wanted;
  std::uint64_t seconds = admission::kInviteSeconds;  // 0: for good
  if (!TakeInvite(order, wanted, seconds, refusal)) return refusal;
  if (order.issuer.rank != Rank::kOwner && wanted.rank >= order.issuer.rank) {
    return Refuse("you may invite only below your own rank");
  }
  std::string error, secret;
  bool isKept = true;
  const std::string line = order.realm.gate.ChangeInvites(
      [&](admission::Invites& invites, std::uint64_t unixNow, const transport::vestibule::RandomSource& random) {
        if (seconds != 0) wanted.until = unixNow + seconds;
        secret = invites.Make(wanted, unixNow, random, error);
        isKept = invites.HasFile();
        return Describe(wanted);
      });
  Answer answer = Done(line);
  answer.lines.push_back("#invite=" + secret);
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  if (!isKept) answer.lines.emplace_back("holds until the server ends: it was started without --invites");
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

Answer RevokeInvite(Order& order) {
  if (order.IsAtEnd()) return Refuse("name an invite by its number (see invites)");
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
  if (ended.number == 0) return Refuse("no invite has the number " + Quote(word) + " (see invites)");
  if (!isAllowed) return Refuse("you may revoke only invites below your own rank");
  Answer answer = Done(fmt::format("invite {} has ended", ended.number));
  if (const std::size_t count = EndRanks(order, ended); count != 0) {
    answer.lines.push_back(fmt::format("{} of those who are in {} a player now", count, count == 1 ? "is" : "are"));
  }
  if (!error.empty()) answer.lines.push_back("holds for this run only: " + error);
  return answer;
}

}  // namespace wobble::admin
