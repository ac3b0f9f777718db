// A short match of two scripted players in a shipped scene, played and recorded.
#pragma once

#include <cstdint>
#include <string>

#include "server/recording/recorder.h"
#include "server/scenes/loader.h"
#include "tests/support/places.h"

namespace wobble::recording {

inline Head MakeHead(const std::string& scene) {
  return {.version = "test",
          .scene = scenes::LoadScene(scene, test::FindSource("server/scenes")).source,
          .tickHz = 60,
          .seed = 1,
          .beginsFresh = true};
}

// What two players do in a tick: run, hold, shove and cut.
inline void ActInMatch(server::Playground& ground) {
  const std::uint32_t tick = ground.World().Tick();
  if (tick == 10) ground.Take(server::JoinEntry{1, false, "Ada"});
  if (tick == 40) ground.Take(server::JoinEntry{2, false, "Bo"});
  if (tick < 50 || ground.World().Bodies().empty()) return;
  const physics::BodyId body = ground.World().Bodies()[tick / 60 % ground.World().Bodies().size()].id;
  const physics::Vector3d at = ground.World().FindCentre(ground.World().ReadBody(body));
  for (const server::ClientId client : {1U, 2U}) {
    server::MoveEntry move{.client = client, .control = {}, .hand = {}};
    move.control.moveX = (tick / 20 + client) % 3 == 0 ? 0.5 : -0.25;
    move.control.jump = tick % 40 == client;
    if (tick / 50 % 2 == 1) move.hand = server::HandCommand{body, 1, static_cast<std::uint16_t>(tick / 50), at};
    if (!ground.IsInForce(move)) ground.Take(move);
  }
  if (tick % 45 == 0) ground.Take(server::ActEntry{.client = 1, .command = server::ShoveCommand{body, 2, {0, 1, 1}}});
  if (tick % 45 == 30) {
    const server::CutCommand cut{body, at + physics::Vector3d(0, -1.5, 0), at + physics::Vector3d(-1, 0.5, 0),
                                 at + physics::Vector3d(1, 0.5, 0.2)};
    ground.Take(server::ActEntry{.client = 2, .command = cut});
  }
}

// Plays a match of so many ticks and records it.
inline RecorderCounts RecordMatch(const std::string& scene, std::uint32_t ticks, const RecorderSettings& settings,
                                  std::uint32_t newFileAt = 0) {
  const Head head = MakeHead(scene);
  server::Playground ground(scenes::ParseScene(head.scene).scene, {});
  Recorder recorder(settings, head, ground);
  ground.SetListener([&](const server::Entry& entry) { recorder.Note(entry, ground.World().Tick()); });
  while (ground.World().Tick() < ticks) {
    if (newFileAt > 0 && ground.World().Tick() == newFileAt) recorder.BeginFile();
    ActInMatch(ground);
    ground.Step();
    recorder.FollowTick(ground);
  }
  recorder.Close();
  return recorder.Counts();
}

}  // namespace wobble::recording
