// Plays one body in its own world, with a double-precision twin that begins each second in the same state.
#include "tests/bench/accuracy/played.h"

namespace wobble::bench {

using namespace physics;

namespace {

WorldSettings MakeSettings(const PlayedCase& played, double errorTarget) {
  WorldSettings settings;
  settings.gravity = played.equations.gravity;
  settings.wind = played.equations.wind;
  settings.errorTarget = errorTarget;
  return settings;
}

PlayedSecond PlayASecond(World& world) {
  WorldSettings settings = world.Settings();
  settings.precision = Precision::kDouble;
  World twin(world, settings);
  PlayedSecond second;
  second.begin = std::get<State<float>>(world.Bodies()[0].state);
  for (int tick = 0; tick < kTicksASecond; ++tick) {
    second.substeps += world.Step().allSubsteps;
    (void)twin.Step();
  }
  second.end = std::get<State<float>>(world.Bodies()[0].state);
  second.endInDouble = std::get<State<double>>(twin.Bodies()[0].state);
  second.asleep = world.Bodies()[0].asleep;
  return second;
}

}  // namespace

std::vector<PlayedSecond> PlayAsServer(const PlayedCase& played, double errorTarget, int seconds) {
  World world(MakeSettings(played, errorTarget));
  world.AddBlueprint(*played.blueprint);
  for (const Obstacle& obstacle : played.equations.obstacles) world.AddObstacle(obstacle);
  const BodyId body = world.AddBody(0, played.x[0] - played.blueprint->rest[0]);
  world.SetMotion(body, played.x, played.v);
  std::vector<PlayedSecond> all;
  for (int second = 0; second < seconds; ++second) all.push_back(PlayASecond(world));
  return all;
}

}  // namespace wobble::bench
