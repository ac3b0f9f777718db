// Each order is a function that takes the words behind its name; the table at the end names them all, with what people
// read about them and the least rank that may give them.
#include "server/admin/orders.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <type_traits>
#include <utility>

#include "protocol/text.h"
#include "server/admin/order.h"
#include "server/admission/rank.h"

namespace wobble::admin {

using protocol::wire::GoodbyeReason;
using server::ClientId;
using transport::Rank;

namespace {

std::string DescribeMute(const server::Server::Player& player) {
  if (!player.isMuted) return "";
  return std::isfinite(player.mutedFor) ? fmt::format(", muted for {:.0f} s", player.mutedFor) : ", muted";
}

Answer ListPlayers(Order& order) {
  Answer answer{.isDone = true, .lines = {}};
  for (const auto& player : order.realm.server.ListPlayers(order.now)) {
    const transport::Admission& admission = player.admission;
    const bool hasAddress = admission.from.ip != transport::NetAddress{}.ip;
    answer.lines.push_back(fmt::format("{:5} {:32} {:9} {:6.0f} s {:4.0f} ms {:5.0f} kbit/s  {}{}{}{}", player.client,
                                       player.name, admission::NameOf(admission.rank), player.seconds,
                                       1000 * player.roundTrip, player.rate / 1000,
                                       hasAddress ? transport::FormatIp(admission.from) : "address unknown",
                                       admission.account != 0 ? fmt::format(", account {}", admission.account) : "",
                                       player.isSpectator ? ", watches" : "", DescribeMute(player)));
  }
  if (answer.lines.empty()) answer.lines.emplace_back("nobody is in");
  return answer;
}

Answer ShowStatus(Order& order) {
  const server::Server& server = order.realm.server;
  const auto muted = std::ranges::count_if(server.ListPlayers(order.now), &server::Server::Player::isMuted);
  return Done(fmt::format("scene {}, {} in, {}, tick {}{}{}", server.SceneName(), server.CountPlaying(),
                          server.IsLocked() ? "locked" : "open", server.World().Tick(),
                          server.IsProtected() ? ", builds are protected" : "",
                          muted == 0 ? "" : fmt::format(", {} muted", muted)));
}

Answer Kick(Order& order) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  order.realm.server.Dismiss(player->client, GoodbyeReason::Kicked, order.TakeRest());
  return Done(player->name + " is out");
}

Answer Mute(Order& order) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  std::uint64_t seconds = 0;
  if (order.TakeIf("for")) {
    const auto span = TakeSpan(order, refusal);
    if (!span) return refusal;
    seconds = *span;
  }
  if (!order.IsAtEnd()) return Refuse("mute takes PLAYER [for TIME]; too much: " + order.TakeRest());
  if (seconds == 0) {
    order.realm.server.Mute(player->client);
    return Done(player->name + " may only move");
  }
  order.realm.server.Mute(player->client, order.now + static_cast<double>(seconds));
  return Done(fmt::format("{} may only move, for {} s", player->name, seconds));
}

Answer Unmute(Order& order) {
  Answer refusal;
  const auto player = TakePlayer(order, refusal);
  if (!player) return refusal;
  order.realm.server.Unmute(player->client);
  return Done(player->name + " may act again");
}

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
    return Refuse("rank " + Quote(word) + ": must be player, moderator or owner");
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

Answer Restart(Order& order) {
  order.realm.server.RestartWorld();
  return Done("the world begins anew: what was torn is whole, and everybody stays in");
}

Answer GoToNextScene(Order& order) {
  const std::string refusal = order.realm.server.GoToNextScene();
  return refusal.empty() ? Done("the next scene begins, and everybody comes along") : Refuse(refusal);
}

Answer GoToScene(Order& order) {
  server::Server& server = order.realm.server;
  if (order.IsAtEnd()) {
    const std::vector<std::string> names = server.ListRotation();
    const std::string others = names.empty() ? "" : fmt::format(" of {}", fmt::join(names, ", "));
    return Done(server.SceneName() + others);
  }
  const std::string name = order.TakeWord();
  const std::string refusal = server.GoToScene(name);
  return refusal.empty() ? Done("scene " + name + " begins, and everybody comes along") : Refuse(refusal);
}

// Everybody who is in is told the count, who votes as well: there is nothing to answer.
Answer Vote(Order& order) {
  using Question = server::Server::Question;
  const std::string word = order.TakeWord();
  if (word != "restart" && word != "next") return Refuse("vote: must be followed by restart or next");
  if (order.issuer.client == 0) return Refuse("players vote; from outside the game the order is " + word);
  const Question question = word == "next" ? Question::kNextScene : Question::kRestart;
  const std::string refusal = order.realm.server.VoteFor(question, order.issuer.client, order.now);
  return refusal.empty() ? Answer{.isDone = true, .lines = {}} : Refuse(refusal);
}

// A player says whether the match may begin.
Answer SetReady(Order& order) {
  const std::string word = order.TakeWord();
  if (!word.empty() && word != "no") return Refuse("ready: may be followed by no");
  if (order.issuer.client == 0) return Refuse("players say that they are ready");
  const std::string refusal = order.realm.server.SetReady(order.issuer.client, word.empty());
  if (!refusal.empty()) return Refuse(refusal);
  const auto standings = order.realm.server.ReadGame()->ReadMatch().Standings();
  const auto ready = std::ranges::count_if(standings, [](const auto& each) { return each.isReady; });
  return Done(fmt::format("{}: {} of {} are ready", word.empty() ? "you are ready" : "you are not ready", ready,
                          standings.size()));
}

std::string FormatTime(double seconds) {
  return fmt::format("{}:{:04.1f}", static_cast<int>(seconds) / 60, std::fmod(seconds, 60));
}

// Clients read it (client/terminal/film.cpp, client/page/source/hud/film_panel.ts).
std::string DescribeFilm(const recording::Film& film) {
  const bool isPlaying = film.ReadMotion() == recording::Film::Motion::kPlaying;
  return fmt::format("{} {} of {}, speed {:g}, tick {}{}", isPlaying ? "plays" : "paused at", FormatTime(film.Time()),
                     FormatTime(film.End()), film.Speed(), film.Tick(),
                     film.IsSeeking() ? ", on the way to " + FormatTime(film.Goal()) : "");
}

// The number behind a word of the order film, in a range. Leaves the reason in `refusal` if there is none.
template <class Number>
std::optional<Number> TakeNumber(Order& order, const std::string& what, double low, double high, Answer& refusal) {
  const std::string word = order.TakeWord();
  Number number{};
  const auto [end, result] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool isWhole = result == std::errc{} && end == word.data() + word.size();
  const auto value = static_cast<double>(number);
  if (isWhole && value >= low && value <= high) return number;
  refusal = Refuse(fmt::format("film {}{}{}: must be {} from {} to {}", what, word.empty() ? "" : " ", word,
                               std::is_integral_v<Number> ? "a whole number" : "a number", low, high));
  return {};
}

Answer WindFilm(Order& order) {
  recording::Film* film = order.realm.server.ReadFilm();
  if (film == nullptr) return Refuse("this server shows no recording");
  constexpr double kLongest = 1e6;
  const std::string what = order.TakeWord();
  Answer refusal;
  if (what == "play") {
    film->Play();
  } else if (what == "pause") {
    film->Pause();
  } else if (what == "speed") {
    const auto speed = TakeNumber<double>(order, what, recording::kLeastFilmSpeed, recording::kMostFilmSpeed, refusal);
    if (!speed) return refusal;
    film->SetSpeed(*speed);
  } else if (what == "step") {
    const auto ticks = TakeNumber<std::int64_t>(order, what, -kLongest, kLongest, refusal);
    if (!ticks) return refusal;
    film->StepBy(*ticks);
  } else if (what == "to" || what == "by") {
    const auto seconds = TakeNumber<double>(order, what, -kLongest, kLongest, refusal);
    if (!seconds) return refusal;
    film->JumpTo(*seconds + (what == "by" ? film->Goal() : 0));
  } else if (!what.empty()) {
    return Refuse("film " + what + ": must be play, pause, speed X, step TICKS, to SECONDS or by SECONDS");
  }
  return Done(DescribeFilm(*film));
}

Answer Say(Order& order) {
  order.realm.server.Say(order.TakeRest());
  return Done("said");
}

Answer ShowHelp(Order& order);

constexpr std::size_t kAnyWords = 1000;

struct Entry {
  const char* name;
  const char* words;
  std::size_t most;  // words behind the name
  const char* help;
  Rank least;
  Answer (*run)(Order&);
  bool isOfPlay = false;  // there is nothing that it could act on while a recording is shown
};

constexpr std::array kEntries{
    Entry{"help", "", 0, "these lines", Rank::kPlayer, ShowHelp},
    Entry{"status", "", 0, "the scene, how many are in, and what is locked or protected", Rank::kModerator, ShowStatus},
    Entry{"players", "", 0, "number, name, rank, time, round trip, budget and address of everybody who is in",
          Rank::kModerator, ListPlayers},
    Entry{"kick", "PLAYER [REASON]", kAnyWords, "sends a player away, who may come back", Rank::kModerator, Kick},
    Entry{"ban", "PLAYER|ADDRESS|account:N [for TIME] [REASON]", kAnyWords,
          "keeps out, for 24h unless TIME says more or less", Rank::kModerator, AddBan},
    Entry{"bans", "", 0, "who is kept out", Rank::kModerator, ListBans},
    Entry{"unban", "BAN|ADDRESS|account:N", 1, "ends a ban", Rank::kModerator, LiftBan},
    Entry{"mute", "PLAYER [for TIME]", 3,
          "lets a player move only: no lines, emotes, new names, hands, tuning or building", Rank::kModerator, Mute},
    Entry{"unmute", "PLAYER", 1, "takes that back", Rank::kModerator, Unmute},
    Entry{"lock", "", 0, "lets only moderators and owners come in", Rank::kModerator, Lock},
    Entry{"unlock", "", 0, "lets everybody come in again", Rank::kModerator, Unlock},
    Entry{"protect", "on|off", 1, "whether players change only what they have built themselves", Rank::kModerator,
          Protect, true},
    Entry{"reset", "", 0, "puts bodies, workshop and tuning back to what the scene has; what is torn stays torn",
          Rank::kModerator, Reset, true},
    Entry{"restart", "", 0, "lets the world begin anew, whole and with a new game; everybody stays in",
          Rank::kModerator, Restart, true},
    Entry{"next", "", 0, "begins the next scene of the rotation; everybody comes along", Rank::kModerator,
          GoToNextScene, true},
    Entry{"scene", "[NAME]", 1, "begins that scene of the rotation; without a name tells which there are",
          Rank::kModerator, GoToScene, true},
    Entry{"vote", "restart|next", 1,
          "lets the world begin anew, or the next scene begin, when more than half of the players vote for it within a "
          "minute",
          Rank::kPlayer, Vote, true},
    Entry{"ready", "[no]", 1, "says that the player is ready, and the match may begin; or is not", Rank::kPlayer,
          SetReady, true},
    Entry{"film", "[play|pause|speed X|step TICKS|to SECONDS|by SECONDS]", 2,
          "winds the recording that is shown; X from -4 to 16", Rank::kWatcher, WindFilm},
    Entry{"say", "TEXT", kAnyWords, "shows a line to everybody", Rank::kModerator, Say},
    Entry{"rank", "PLAYER player|moderator|owner", 2, "appoints a player until it leaves", Rank::kOwner, ChangeRank},
    Entry{"hand-over", "PLAYER", 1, "makes a player the owner instead of who orders it", Rank::kOwner, HandOver},
    Entry{"invite", "[RANK] [for TIME] [uses N]", kAnyWords,
          "makes a link: for a player, 24h and any number of uses unless said", Rank::kModerator, MakeInvite},
    Entry{"invites", "", 0, "the invites that hold", Rank::kModerator, ListInvites},
    Entry{"revoke", "INVITE", 1, "ends an invite by its number", Rank::kModerator, RevokeInvite},
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

// Words that an order does not know may change what its issuer means: "mute 2 for 1h".
Answer RefuseRest(Order& order, const Entry& entry) {
  for (std::size_t i = 0; i < entry.most; ++i) order.TakeWord();
  return Refuse(fmt::format("{} takes {}; too much: {}", entry.name, *entry.words == 0 ? "no words" : entry.words,
                            order.TakeRest()));
}

}  // namespace

Answer CarryOut(const Realm& realm, const Issuer& issuer, const std::string& line, double now) {
  if (line.size() > protocol::kMaxOrderBytes) {
    return Refuse(fmt::format("an order has {} bytes at most; this one has {}", protocol::kMaxOrderBytes, line.size()));
  }
  Order order{.realm = realm, .issuer = issuer, .now = now};
  std::istringstream in(protocol::MakeLine(line, protocol::kMaxOrderBytes));
  for (std::string word; in >> word;) order.words.push_back(word);
  const std::string name = order.TakeWord();
  if (name.empty()) return Refuse("an order is missing (see help)");
  const auto entry =
      std::find_if(kEntries.begin(), kEntries.end(), [&](const Entry& each) { return each.name == name; });
  if (entry == kEntries.end()) return Refuse("there is no order \"" + name + "\" (see help)");
  if (issuer.rank < entry->least) {
    return Refuse(fmt::format("{} is for {}s and above; you are {}", name, admission::NameOf(entry->least),
                              admission::NameOf(issuer.rank)));
  }
  if (entry->isOfPlay && realm.server.ReadFilm() != nullptr) {
    return Refuse(name + ": a recording is shown; film to 0 begins it anew");
  }
  Answer answer = order.words.size() > entry->most ? RefuseRest(order, *entry) : entry->run(order);
  if (name == "film" && issuer.client != 0) return answer;  // watchers ask where it stands twice a second
  // The answer may hold a secret; the order never does.
  spdlog::info("order of {}: {} ({})", issuer.client == 0 ? issuer.way : fmt::format("client {}", issuer.client),
               protocol::MakeLine(line, protocol::kMaxOrderBytes), answer.isDone ? "done" : answer.lines.front());
  return answer;
}

}  // namespace wobble::admin
