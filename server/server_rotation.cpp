// The part of the server that goes from scene to scene with everybody taken along. The next scene is made on another
// thread while the present one is played; then clients are told, say hello again on the same connection, and are
// welcomed as newcomers are. A new connection for everybody was rejected: a server lets an address begin a few
// connections a second, so that a class or a gateway would be back one by one, without their ranks.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cassert>

#include "server/server.h"

namespace wobble::server {

void Server::Rotate(std::vector<RotationScene> scenes) {
  assert(scenes.size() >= 2 && scenes.front().scene.name == SceneName());
  m_rotation = std::move(scenes);
}

void Server::BeginWith(std::size_t scene) {
  if (scene == m_scene) return;
  const RotationScene& chosen = m_rotation[scene];
  TakeStage(std::make_unique<Stage>(m_config, chosen.scene, chosen.bases, m_watch), scene);
}

std::vector<std::string> Server::ListRotation() const {
  std::vector<std::string> names;
  for (const RotationScene& each : m_rotation) names.push_back(each.scene.name);
  return names;
}

std::string Server::GoToScene(const std::string& name) {
  const std::vector<std::string> names = ListRotation();
  if (names.empty()) return "this server stays in its scene (see --rotation)";
  if (m_nextStage.valid()) return "scene " + names[m_nextScene] + " is about to begin";
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return fmt::format("scene {}: must be one of {}", name, fmt::join(names, ", "));
  MakeNextStage(static_cast<std::size_t>(found - names.begin()));
  return {};
}

std::string Server::GoToNextScene() {
  if (m_rotation.empty()) return GoToScene("");
  return GoToScene(m_rotation[(m_scene + 1) % m_rotation.size()].scene.name);
}

void Server::MakeNextStage(std::size_t scene) {
  m_nextScene = scene;
  // Without a clock nothing takes time.
  const auto when = m_watch.HasClock() ? std::launch::async : std::launch::deferred;
  m_nextStage = std::async(when, [this, &chosen = m_rotation[scene]] {
    return std::make_unique<Stage>(m_config, chosen.scene, chosen.bases, m_watch);
  });
}

void Server::FollowRotation(double now) {
  if (!m_nextStage.valid() || m_nextStage.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
  for (auto& [connection, session] : m_sessions) {
    if (session.state == Session::State::kPlaying) TakeAlong(session, now);
  }
  TakeStage(m_nextStage.get(), m_nextScene);
  SaveState();
}

void Server::TakeAlong(Session& session, double now) {
  SendTo(session, protocol::MakeNextScene(m_rotation[m_nextScene].scene.name));
  session.joinPatience = protocol::FindJoinPatience(m_transport->ReadRoundTrip(session.connection));
  AwaitHelloAgain(session, now);
}

void Server::TakeStage(std::unique_ptr<Stage> stage, std::size_t scene) {
  m_counts.coarsenedBefore = CoarsenedRecords();
  m_stage = std::move(stage);
  m_scene = scene;
  m_emptySeats.clear();
  if (m_vote.IsOpen()) m_vote = {};
  m_clock.SetRate(1);
  m_sentStandings.reset();
  PublishBlueprints();
  if (m_recorder != nullptr) {
    m_recorder->BeginScene(m_rotation[scene].source, m_stage->playground);
    RecordStage();
  }
  spdlog::info("tick {}: scene {} begins", m_shownTick, SceneName());
}

}  // namespace wobble::server
