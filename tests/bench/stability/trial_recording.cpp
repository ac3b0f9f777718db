// The trial's own world goes on beside the playground that is recorded: what has been done to it before a step is found
// by comparing it with what it was, becomes an entry, and after the step both must have the same hash.
#include "tests/bench/stability/trial_recording.h"

#include <ctime>
#include <map>

#include "protocol/version.h"
#include "server/physics/world_state.h"
#include "server/play/playground_state.h"
#include "server/recording/recorder.h"
#include "tests/bench/stability/scene_text.h"

namespace wobble::bench {
namespace {

using namespace physics;
using server::Playground;

// Of what Act may change.
struct Deeds {
  Vector3d gravity = Vector3d::Zero();
  std::map<BodyId, Control> controls;
  std::map<BodyId, std::vector<Vector3d>> velocities;
};

std::vector<Vector3d> ListVelocities(const Body& body) {
  return std::visit(
      [](const auto& state) {
        std::vector<Vector3d> velocities;
        for (const auto& each : state.velocities) velocities.push_back(each.template cast<double>());
        return velocities;
      },
      body.state);
}

Deeds ReadDeeds(const World& world) {
  Deeds deeds{.gravity = world.Settings().gravity, .controls = {}, .velocities = {}};
  for (const Body& body : world.Bodies()) {
    deeds.controls[body.id] = body.control;
    deeds.velocities[body.id] = ListVelocities(body);
  }
  return deeds;
}

server::MotionEntry MakeMotion(const Body& body) {
  server::MotionEntry motion{.body = body.id, .positions = {}, .velocities = ListVelocities(body)};
  VisitVertices(body, [&](std::size_t, const Vector3d& at) { motion.positions.push_back(at); });
  return motion;
}

// Every body is some player's, whose number is the body's.
void Take(const Deeds& before, const World& world, Playground& ground) {
  if (world.Settings().gravity != before.gravity) {
    const server::TuneCommand tune{server::TuneCommand::Kind::kGravity, world.Settings().gravity};
    ground.Take(server::ActEntry{.client = world.Bodies().front().id, .isHost = true, .command = tune});
  }
  for (const Body& body : world.Bodies()) {
    if (ListVelocities(body) != before.velocities.at(body.id)) ground.Take(MakeMotion(body));
    if (body.control == before.controls.at(body.id)) continue;
    ground.Take(server::MoveEntry{.client = body.id, .control = body.control, .hand = {}});
  }
}

server::PlaygroundState MakeBeginning(const World& world, const Playground& ground) {
  server::PlaygroundState state = ground.Capture();
  state.world = world.Capture();
  state.gravity = world.Settings().gravity;
  for (const Body& body : world.Bodies()) {
    state.players[body.id] = {
        .body = body.id, .name = "body " + std::to_string(body.id), .control = body.control, .hand = {}};
  }
  return state;
}

}  // namespace

TrialRecording RecordTrial(std::uint64_t seed, std::uint32_t number, int ticks, const std::filesystem::path& folder) {
  RandomWorld random(seed, number);
  World& world = random.Engine();
  const std::string name = "trial-" + std::to_string(number) + "-seed-" + std::to_string(seed);
  recording::Head head{.version = kVersion, .scene = WriteScene(random, name)};
  scenes::LoadResult loaded = scenes::ParseScene(head.scene);
  if (!loaded.errors.empty()) return {.file = {}, .fault = "it is no scene: " + loaded.errors.front()};
  Playground ground(std::move(loaded.scene), {});
  const std::string error = ground.Restore(MakeBeginning(world, ground));
  if (!error.empty()) return {.file = {}, .fault = "it cannot begin: " + error};
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  recording::Recorder recorder(
      {.folder = folder, .readUnixTime = [] { return static_cast<std::uint64_t>(std::time(nullptr)); }},
      std::move(head), ground);
  ground.SetListener([&](const server::Entry& entry) { recorder.Note(entry, ground.World().Tick()); });
  TrialRecording made;
  for (int tick = 1; tick <= ticks; ++tick) {
    const Deeds before = ReadDeeds(world);
    random.Act();
    Take(before, world, ground);
    world.Step();
    ground.Step();
    recorder.FollowTick(ground);
    if (made.fault.empty() && world.Hash() != ground.World().Hash()) {
      made.fault = "it differs from the trial from tick " + std::to_string(tick) + " on";
    }
  }
  recorder.Close();
  made.file = recorder.Path();
  if (recorder.Counts().failures > 0) return {.file = {}, .fault = recorder.Error()};
  return made;
}

}  // namespace wobble::bench
