// The rules of goals: two sides and one big ball. When the ball's centre is across a side's goal line, between the
// posts and below the bar, the other side has a goal, and all are put back for the kick-off.
#pragma once

#include <array>

#include "server/play/match.h"

namespace wobble::server {

struct Goals {
  std::array<ClientId, 2> touchedBy{};  // the last of each side who touched the ball since the kick-off; 0: nobody

  void NoteTouch(const Match& match, ClientId client);
  void Forget(ClientId client);
  // The side in whose goal a ball at this place is; 0: in none.
  [[nodiscard]] static int FindGoal(const scenes::GameRules& rules, const physics::Vector3d& centre);
  // Scores a ball that is in a goal. Returns whether it has; `scorer`: the last of the side that gains who touched it.
  bool FollowBall(const scenes::GameRules& rules, const physics::Vector3d& centre, Match& match, ClientId& scorer);
};

}  // namespace wobble::server
