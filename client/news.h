// What the server tells beside the world itself: how it is tuned, how a game stands, the forces on a body.
#pragma once

#include "client/client.h"

namespace wobble::client {

struct News {
  Tuning tuning;
  Scoreboard scoreboard;
  Forces forces;

  // Takes a message that ParseServerMessage has passed. False when it is none of these.
  [[nodiscard]] bool Take(const wire::ServerMessage& message);
};

}  // namespace wobble::client
