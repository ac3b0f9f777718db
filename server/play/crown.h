// The rules of crown: who wears it gets a point a second. A hand that grabs it puts it on its owner's head, where it
// stays without a key held. Another hand that grabs it takes it over, and a push at its bearer knocks it off. For a
// second after it has changed hands nobody takes it over, and who has lost it cannot have it back.
#pragma once

#include <vector>

#include "server/play/hands.h"
#include "server/play/match.h"

namespace wobble::server {

// How fast the bearer runs, as a share of the others' speed and acceleration: so they are caught.
inline constexpr double kBearersShare = 0.85;

struct Crown {
  ClientId bearer = 0;  // 0: nobody
  ClientId loser = 0;   // who lost it last
  double since = 1e3;   // since it has changed hands, s
  double worn = 0;      // since the bearer's last point, s
  // How the bearer's hand holds it.
  std::uint16_t vertex = 0;
  std::uint16_t grip = 0;
  physics::Vector3d lift = physics::Vector3d::Zero();  // from its centre to that vertex when it is upright, m

  // A hand that holds the crown.
  struct Grasp {
    ClientId client = 0;
    HandCommand command;
    physics::Vector3d lift = physics::Vector3d::Zero();
  };
  // What hands do to the crown and its bearer in a tick.
  struct Deeds {
    std::vector<Grasp> grasps;  // hands that hold it, the bearer's too, by ascending client
    bool isPushed = false;      // whether somebody pushes the bearer
  };
  // Follows a tick, s. Returns the player who has taken it; 0: nobody has. opened: hands that must let go of it.
  ClientId Follow(const Deeds& deeds, double seconds, Match& match, std::vector<ClientId>& opened);
  // It lies free: its bearer has fallen, or all are put back.
  void Drop();
  void Forget(ClientId client);
  // How the bearer's hand holds the crown on the head; head: the centre of the bearer's body; reaches of both bodies,
  // m.
  [[nodiscard]] HandCommand FindHand(physics::BodyId crown, const physics::Vector3d& head, double ownReach,
                                     double crownReach) const;
};

}  // namespace wobble::server
