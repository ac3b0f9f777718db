#include "server/play/goals.h"

#include <cmath>

namespace wobble::server {

void Goals::NoteTouch(const Match& match, ClientId client) {
  const Match::Standing* standing = match.Find(client);
  if (standing != nullptr && standing->side != 0) touchedBy[static_cast<std::size_t>(standing->side - 1)] = client;
}

void Goals::Forget(ClientId client) {
  for (ClientId& each : touchedBy) each = each == client ? 0 : each;
}

int Goals::FindGoal(const scenes::GameRules& rules, const physics::Vector3d& centre) {
  const bool isBehindLine = std::abs(centre.x()) > rules.goalLine;
  const bool isInMouth = std::abs(centre.y()) < rules.goalHalfWidth && centre.z() > 0 && centre.z() < rules.goalHeight;
  return !isBehindLine || !isInMouth ? 0 : centre.x() < 0 ? 1 : 2;
}

bool Goals::FollowBall(const scenes::GameRules& rules, const physics::Vector3d& centre, Match& match,
                       ClientId& scorer) {
  const int conceding = match.IsCounting() ? FindGoal(rules, centre) : 0;
  if (conceding == 0) return false;
  const int side = 3 - conceding;
  scorer = touchedBy[static_cast<std::size_t>(side - 1)];
  // Who changed sides since scores for nobody.
  const Match::Standing* standing = match.Find(scorer);
  if (standing == nullptr || standing->side != side) scorer = 0;
  match.Score(scorer, side);
  touchedBy = {};
  return true;
}

}  // namespace wobble::server
