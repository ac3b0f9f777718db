#include "client/terminal/people.h"

#include "client/terminal/status.h"

namespace wobble::terminal {

std::string MakePlain(std::string text) {
  for (char& c : text) {
    if (c < 0x20 || c >= 0x7F) c = '?';
  }
  return text;
}

std::string People::Note(const client::Client::Event& event) {
  if (m_areOld) {
    m_players.clear();
    m_owners.clear();
    m_clients.clear();
    m_areOld = false;
  }
  switch (event.kind) {
    case wire::EventKind::Join:
      Name(event);
      return {};
    case wire::EventKind::Leave:
      m_players.erase(event.body);
      m_owners.erase(event.body);
      m_clients.erase(event.clientId);
      return {};
    case wire::EventKind::Fall: {
      const auto fallen = m_players.find(event.body);
      const std::string who = fallen == m_players.end() ? "somebody" : fallen->second;
      return event.clientId == 0 ? who + " fell off" : NameOf(event.clientId) + " pushed " + who + " off";
    }
    case wire::EventKind::Said:
      return NameOf(event.clientId) + ": " + MakePlain(event.name);
    case wire::EventKind::Emote:
      return NameOf(event.clientId) + " " + DescribeEmote(event.emote);
    case wire::EventKind::Rename: {
      const std::string before = NameOf(event.clientId);
      Name(event);
      return before + " is " + NameOf(event.clientId) + " now";
    }
    case wire::EventKind::Goal:
      return event.clientId == 0 ? "own goal" : "goal by " + NameOf(event.clientId);
    case wire::EventKind::Crown:
      return NameOf(event.clientId) + " has the crown";
    case wire::EventKind::Respawn:
    case wire::EventKind::BodyRemoved:
      return {};
  }
  return {};  // of a server that knows more events
}

void People::Name(const client::Client::Event& event) {
  const std::string name = MakePlain(event.name);
  if (event.body != 0) m_players[event.body] = name;
  if (event.body != 0) m_owners[event.body] = event.clientId;
  m_clients[event.clientId] = name;
}

std::uint32_t People::FindOwner(std::uint32_t body) const {
  const auto owner = m_owners.find(body);
  return owner == m_owners.end() ? 0 : owner->second;
}

std::string People::NameOf(std::uint32_t clientId) const {
  const auto found = m_clients.find(clientId);
  return found == m_clients.end() ? "somebody" : found->second;
}

}  // namespace wobble::terminal
