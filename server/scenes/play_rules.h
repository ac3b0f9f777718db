// What players may do in a scene beyond moving about, and the game they play, as plain data.
#pragma once

#include <cstddef>

namespace wobble::scenes {

// What hands may do to bodies. Nothing unless the scene says so.
struct HandRules {
  bool grab = false;
  bool cut = false;
  bool push = false;
  // From the own body's centre to what is held, cut or pushed, m. Whoever drags is dragged himself by the same force.
  // 0: from anywhere, by hands that belong to no body.
  double reach = 0;
  double radius = 0.25;   // of what is held round the vertex, m
  double strength = 200;  // the largest force of a grip, N
  double impulse = 16;    // of a push, N·s
};

enum class Who { kNobody, kHost, kEveryone };  // kHost: who has played longest of those who are there

// Who may tune what everybody feels.
struct TuningRules {
  Who gravity = Who::kNobody;
  Who stiffness = Who::kNobody;
  Who time = Who::kNobody;
};

// The one body of this blueprint, a graph, is built on by all players. All limits hold at once.
struct WorkshopRules {
  bool isOpen = false;
  std::size_t blueprint = 0;
  int particlesEach = 48;  // of one player
  int springsEach = 144;
};

// Sumo: who falls below the scene's kill height gives a point to who touched him last.
struct GameRules {
  enum class Kind { kNone, kSumo };
  Kind kind = Kind::kNone;
  double roundSeconds = 120;  // s
  int pointsToWin = 5;        // that end a round at once
};

}  // namespace wobble::scenes
