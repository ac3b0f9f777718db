#include "server/play/crown.h"

#include <algorithm>

namespace wobble::server {
namespace {

constexpr double kPause = 1;         // after the crown has changed hands, s
constexpr double kPointTime = 1;     // of wearing it for a point, s
constexpr double kCrownSinks = 0.5;  // share of the crown's reach by which it sits lower than just above the body

}  // namespace

void Crown::Drop() {
  loser = bearer;
  bearer = 0;
  since = worn = 0;
}

void Crown::Forget(ClientId client) {
  if (bearer == client) Drop();
  if (loser == client) loser = 0;
}

ClientId Crown::Follow(const Deeds& deeds, double seconds, Match& match, std::vector<ClientId>& opened) {
  since += seconds;
  const auto isSettled = [this] { return since >= kPause; };
  const auto isBearers = [&](const Grasp& grasp) { return grasp.client == bearer; };
  if (bearer != 0 && std::ranges::none_of(deeds.grasps, isBearers)) Drop();  // it has slipped
  if (bearer != 0 && deeds.isPushed && isSettled()) {
    opened.push_back(bearer);
    Drop();
  }
  ClientId taker = 0;
  for (const Grasp& grasp : deeds.grasps) {
    if (grasp.client == bearer) continue;
    const bool mayTake = taker == 0 && (isSettled() || (bearer == 0 && grasp.client != loser));
    if (!mayTake) {
      if (std::ranges::find(opened, grasp.client) == opened.end()) opened.push_back(grasp.client);
      continue;
    }
    if (bearer != 0) opened.push_back(bearer);
    taker = grasp.client;
    vertex = grasp.command.vertex;
    grip = grasp.command.grip;
    lift = grasp.lift;
  }
  if (taker != 0) {
    loser = bearer != 0 ? bearer : loser;
    bearer = taker;
    since = worn = 0;
    return taker;
  }
  if (bearer == 0 || !match.IsCounting()) return 0;
  worn += seconds;
  if (worn < kPointTime) return 0;
  worn -= kPointTime;
  match.Score(bearer);
  return 0;
}

HandCommand Crown::FindHand(physics::BodyId crown, const physics::Vector3d& head, double ownReach,
                            double crownReach) const {
  const double height = ownReach + (1 - kCrownSinks) * crownReach;
  return {.body = crown, .vertex = vertex, .grip = grip, .target = head + physics::Vector3d(0, 0, height) + lift};
}

}  // namespace wobble::server
