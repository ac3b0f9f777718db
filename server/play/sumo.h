// The rules of sumo: push the others off. A player who falls gives a point to the player who touched them last.
#pragma once

#include <map>

#include "server/play/match.h"

namespace wobble::server {

struct Sumo {
  struct Touch {
    ClientId by = 0;
    double at = 0;  // as Match::Memory::now, s
  };
  std::map<ClientId, Touch> touches;  // the last of each player

  // Notes that two players touch now.
  void NoteTouch(const Match& match, ClientId a, ClientId b);
  void Forget(ClientId client) { touches.erase(client); }
  // Scores a fall. Returns the player who gets the point; 0: no touch within the last 6 s, or no round is played.
  ClientId NoteFall(Match& match, ClientId fallen);
};

}  // namespace wobble::server
