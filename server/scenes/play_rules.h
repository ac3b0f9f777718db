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

// The game that is played; server/play has the rules of each.
struct GameRules {
  enum class Kind { kNone, kSumo, kGoals, kCrown };
  Kind kind = Kind::kNone;
  double roundSeconds = 120;  // s
  int pointsToWin = 5;        // who has so many wins the round at once
  int rounds = 0;             // that make a match; 0: it never ends
  // The longest that a match waits for its players to say that they are ready, s; 0: it does not wait.
  double lobbySeconds = 0;
  std::size_t object = 0;  // goals, crown: blueprint of the ball or the crown, of which there is one body
  // Goals: the mouth of each goal, m. Side 1 defends the one at x = -goalLine, side 2 that at +goalLine.
  double goalLine = 14;
  double goalHalfWidth = 3;
  double goalHeight = 3;
  double kickOff = 6;  // goals: from the middle to where a side starts, along x, m

  [[nodiscard]] bool HasSides() const { return kind == Kind::kGoals; }
  [[nodiscard]] bool HasObject() const { return kind == Kind::kGoals || kind == Kind::kCrown; }
};
// As scenes and clients have it; empty: none.
[[nodiscard]] constexpr const char* NameOf(GameRules::Kind kind) {
  switch (kind) {
    case GameRules::Kind::kSumo:
      return "sumo";
    case GameRules::Kind::kGoals:
      return "goals";
    case GameRules::Kind::kCrown:
      return "crown";
    case GameRules::Kind::kNone:
      break;
  }
  return "";
}

}  // namespace wobble::scenes
