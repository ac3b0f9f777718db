// Who plays, by the server's events, and what these events say in words.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "client/client.h"

namespace wobble::terminal {

// Replaces all but printable ASCII: one cell per character.
std::string MakePlain(std::string text);

class People {
 public:
  // Takes in what has happened. Returns a line that says so; empty: there is nothing to say.
  std::string Note(const client::Client::Event& event);
  // Another connection or scene begins. Who was there is kept until its first event, since it is still shown.
  void BeginAnew() { m_areOld = true; }

  // Names by body.
  [[nodiscard]] const std::map<std::uint32_t, std::string>& Players() const { return m_players; }
  // The client of a body; 0: nobody's.
  [[nodiscard]] std::uint32_t FindOwner(std::uint32_t body) const;
  // "somebody" where it is not known.
  [[nodiscard]] std::string NameOf(std::uint32_t clientId) const;

 private:
  void Name(const client::Client::Event& event);

  std::map<std::uint32_t, std::string> m_players;   // names by body
  std::map<std::uint32_t, std::string> m_clients;   // names by client
  std::map<std::uint32_t, std::uint32_t> m_owners;  // clients by body
  bool m_areOld = false;
};

}  // namespace wobble::terminal
