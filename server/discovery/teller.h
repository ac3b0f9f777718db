// The room server/discovery lets a world be found: what it tells strangers who ask (protocol/server_query.h), and its
// announcement in the local network. This file makes the picture of the world that both tell.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/server_query.h"
#include "protocol/transport/vestibule/query_desk.h"
#include "server/server.h"

namespace wobble::discovery {

// What stays as it is while the server runs.
struct Identity {
  std::string name = {};  // empty: the scene's
  std::string version = {};
  std::uint16_t port = 0;
  std::string key = {};  // of the server, 64 hexadecimal digits
  int maxClients = 0;
  bool wantsCredential = false;  // clients without one are refused
};

// Empty: it may be a server's name; else what is wrong with it. An empty name is fine.
[[nodiscard]] std::string FindFault(const std::string& name);

// Names of players are told where everybody may come in and read them anyway; where a credential is asked for, or the
// world is locked, only how many are in. now: of the server's clock, s.
[[nodiscard]] protocol::ServerPicture MakePicture(const server::Server& server, const Identity& identity, double now);

// Hands the newest picture over once a second, to each who tells it.
class Teller {
 public:
  using Slots = std::vector<std::shared_ptr<transport::vestibule::PictureSlot>>;
  Teller(Identity identity, Slots slots) : m_identity(std::move(identity)), m_slots(std::move(slots)) {}
  // On the thread of the ticks, between two of them.
  void Update(const server::Server& server, double now);

 private:
  Identity m_identity;
  Slots m_slots;
  double m_next = 0;  // s
};

}  // namespace wobble::discovery
