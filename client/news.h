// Reports of the server besides the bodies: tuning, scoreboard, the forces on an inspected body.
#pragma once

#include "client/client.h"

namespace wobble::client {

struct News {
  Tuning tuning;
  Scoreboard scoreboard;
  Forces forces;

  // Takes a message that ParseServerMessage has passed. False when it is of another kind.
  [[nodiscard]] bool Take(const wire::ServerMessage& message);
};

}  // namespace wobble::client
