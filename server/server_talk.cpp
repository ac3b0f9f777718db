// The part of the server that lets players tell one another something: lines, emotes, and new names. Nothing of it
// enters the world, so recordings have none of the lines and emotes; a new name they have, since it stands over a body.
//
// A line goes to all, so what one client sends costs a message for each: there is a measure for each client, and one
// for all together, by which a crowd of clients takes no more of a tick than a few would.
#include <spdlog/spdlog.h>

#include "server/names.h"
#include "server/server.h"

namespace wobble::server {

using protocol::wire::EmoteKind;
using protocol::wire::EventKind;

namespace {

// Lines and emotes of one client, a second and at once; of all clients, which is more than people can read.
constexpr double kTalkRate = 1, kMostTalk = 4, kTalkRateOfAll = 20;
// The same of new names. To find one that is free takes 2 us for each client that is in.
constexpr double kRenameRate = 0.2, kMostRenames = 2, kRenameRateOfAll = 4;

}  // namespace

void Server::TakeTalk(Session& session, const TalkCommand& talk, double now) {
  std::string refusal = session.isMuted ? kMuted : "";
  if (refusal.empty()) refusal = std::visit([&](const auto& each) { return Do(session, each, now); }, talk);
  if (!refusal.empty()) ++m_counts.talkRefused;
  // Once, or who sends too much would be sent as much.
  if (!refusal.empty() && refusal != session.talkRefusal) Notify(session, refusal);
  session.talkRefusal = std::move(refusal);
}

std::uint8_t Server::FindTalk(const Session& session) const {
  const bool mayTalk = !session.spectator || session.admission.rank >= transport::Rank::kModerator;
  const int say = mayTalk && !m_config.forbidsChat ? protocol::kMaySay : 0;
  return static_cast<std::uint8_t>(say | (session.spectator ? 0 : protocol::kMayEmote));
}

std::string Server::Do(Session& session, const SayCommand& say, double now) {
  if (m_config.forbidsChat) return "nobody says lines here: the host has switched that off";
  if ((FindTalk(session) & protocol::kMaySay) == 0) return "who watches reads lines and says none";
  const std::string line = CleanText(say.text, protocol::kMaxSaidBytes);
  if (line.empty()) return "the line was not sent: there is nothing in it";
  if (!session.talk.Take(now, kTalkRate, kMostTalk)) return "the line was not sent: that was too fast";
  if (!m_talk.Take(now, kTalkRateOfAll)) return "the line was not sent: too much is said at once here";
  ++m_counts.said;
  spdlog::info("client {} ({}) says: {}", session.clientId, session.name, line);
  Broadcast(protocol::MakeEvent(EventKind::Said, m_shownTick, session.clientId, session.body, line));
  return {};
}

std::string Server::Do(Session& session, const EmoteCommand& emote, double now) {
  if (session.spectator) return "who watches has no body to show that";
  if (!session.talk.Take(now, kTalkRate, kMostTalk)) return "that was not shown: too fast";
  if (!m_talk.Take(now, kTalkRateOfAll)) return "that was not shown: too much is said at once here";
  ++m_counts.emotes;
  Broadcast(protocol::MakeEvent(EventKind::Emote, m_shownTick, session.clientId, session.body, "",
                                static_cast<EmoteKind>(emote.kind)));
  return {};
}

std::string Server::Do(Session& session, const RenameCommand& rename, double now) {
  if (session.admission.name[0] != '\0') return "your name is the one that your token gives you";
  const std::string name = CleanName(rename.name);
  if (name == session.name) return {};
  if (!session.renames.Take(now, kRenameRate, kMostRenames) || !m_renames.Take(now, kRenameRateOfAll)) {
    return "your name is as before: that was too fast, try again in some seconds";
  }
  const std::string before = std::exchange(session.name, FindFreeName(session, name));
  if (session.name == before) return {};
  ++m_counts.renames;
  spdlog::info("client {} ({}) is {} now", session.clientId, before, session.name);
  if (m_film == nullptr) {
    m_stage->playground.Take(JoinEntry{session.clientId, session.spectator, session.name});
  }
  Broadcast(protocol::MakeEvent(EventKind::Rename, m_shownTick, session.clientId, session.body, session.name));
  return {};
}

std::string Server::FindFreeName(const Session& session, const std::string& name) const {
  std::vector<std::string_view> taken;
  for (const auto& [connection, other] : m_sessions) {
    if (other.IsIn() && &other != &session) taken.push_back(other.name);
  }
  return MakeDistinct(name, taken);
}

}  // namespace wobble::server
