// Drops a soft ball for two seconds and prints the height of its centre: the engine without server, scene or network.
#include <cstdio>

#include "server/physics/shapes/ball.h"
#include "server/physics/world.h"

int main() {
  using namespace wobble::physics;
  World world(WorldSettings{});                        // 60 ticks a second, RK4, substeps chosen per body
  world.AddObstacle(Obstacle{});                       // the plane z = 0
  const auto kind = world.AddBlueprint(MakeBall({}));  // 162 vertices, radius 0.5 m, 8 kg
  const BodyId ball = world.AddBody(kind, {0, 0, 3});  // metres, z is up
  for (int tick = 0; tick <= 120; ++tick) {
    if (tick % 20 == 0) {
      std::printf("t %4.2f s  z %6.3f m\n", tick / 60.0, world.FindCentre(world.ReadBody(ball)).z());
    }
    world.Step();
  }
}
