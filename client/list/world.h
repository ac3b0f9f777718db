// The room client/list finds worlds: in the local network, or in a public list. This file has what is known of one.
#pragma once

#include <optional>
#include <string>

#include "protocol/server_query.h"
#include "protocol/transport/net_address.h"

namespace wobble::list {

struct World {
  std::string address;             // HOST:PORT, as people write it; of a public list as it came
  transport::NetAddress resolved;  // port 0: the address is not known
  // What announced or listed it says, and in place of that what the world itself has answered. Texts as they came.
  protocol::ServerPicture told = {};
  std::string key = {};             // of the server; empty: it was not said
  std::optional<double> ping = {};  // s; nullopt: the world has not answered
};

}  // namespace wobble::list
