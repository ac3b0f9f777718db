// The rules of a scene for players, as plain data: hands, tuning, workshop and game.
#pragma once

#include <cstddef>

namespace wobble::scenes {

// The rules of hands; by default they may do nothing.
struct HandRules {
  bool grab = false;
  bool cut = false;
  bool push = false;
  // The largest distance from the own body's centre to what is held, cut or pushed, m; the reaction then acts on the
  // own body. 0: unlimited, without reaction.
  double reach = 0;
  double radius = 0.25;   // vertices within this distance of the gripped one are held, m
  double strength = 200;  // largest force of a grip, N
  double impulse = 16;    // of a push, N·s
};

enum class Who { kNobody, kHost, kEveryone };  // kHost: who owns the server

// The rules of tuning, which all players feel.
struct TuningRules {
  Who gravity = Who::kNobody;
  Who stiffness = Who::kNobody;
  Who time = Who::kNobody;
};

// All players build on the one body of this blueprint, a graph.
struct WorkshopRules {
  bool isOpen = false;
  std::size_t blueprint = 0;
  int particlesEach = 48;  // the most of one player
  int springsEach = 144;
  bool isProtected = false;  // players change only what they have built themselves
};

// Sumo: a player who falls below the scene's kill height gives a point to the player who touched them last.
struct GameRules {
  enum class Kind { kNone, kSumo };
  Kind kind = Kind::kNone;
  double roundSeconds = 120;  // s
  int pointsToWin = 5;        // a player with so many wins the round at once
};

}  // namespace wobble::scenes
