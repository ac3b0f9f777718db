// The own body ahead of the others, in a whole game on virtual time: arena, six bots and a player who walks like a
// person, 100 ms of round trip with jitter and loss. The player's frames lie between the ticks of the server.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <vector>

#include "tests/support/game.h"

namespace wobble::test {
namespace {

constexpr double kRadius = 0.5;    // of arena's players, m
constexpr double kPhase = 0.007;   // of a frame after a tick, s
constexpr double kFrame = 1.0 / 60;

// Walks in one direction for a while, jumps now and then, and turns back before the edge: wander.lua in C++.
class Walker {
 public:
  explicit Walker(unsigned seed) : m_random(seed) {}

  client::Input Walk(const client::Client& client, double now) {
    const auto pose = client.NewestPose(client.Welcome().ownBody);
    if (pose && now >= m_until) {
      const protocol::Vector3& at = pose->centroid;
      const bool isFar = std::hypot(at.x, at.y) > 6;
      const double angle = isFar ? std::atan2(-at.y, -at.x) + Draw() - 0.5 : 2 * 3.14159265 * Draw();
      m_input.moveX = static_cast<float>(std::cos(angle));
      m_input.moveY = static_cast<float>(std::sin(angle));
      if (Draw() < 0.15) m_input.moveX = m_input.moveY = 0;
      m_jumpUntil = Draw() < 0.35 ? now + 0.1 : 0;
      m_until = now + 0.4 + 1.6 * Draw();
    }
    m_input.jump = now < m_jumpUntil;
    return m_input;
  }

 private:
  double Draw() { return static_cast<double>(m_random() % 10000) / 10000; }

  std::mt19937 m_random;
  client::Input m_input;
  double m_until = 0;
  double m_jumpUntil = 0;
};

struct Truth {
  physics::Vector3d centre;
  bool touchesBody = false;
  bool touchesGround = false;
};

physics::Vector3d ToVector(const protocol::Vector3& v) { return {v.x, v.y, v.z}; }

class Arena {
 public:
  explicit Arena(bool predict, unsigned bots = 6)
      : game(LoadShippedScene("arena")), player(game.network.MakeClient(), {.predict = predict}, 0) {
    game.network.SetConditions({.loss = 0.01, .delay = 0.05, .jitter = 0.01});
    for (unsigned i = 0; i < bots; ++i) {
      game.AddClient({.decode = false});
      walkers.emplace_back(i + 1);
    }
  }

  // A tick of the world and a frame of the player. Frame(now) is called between the player's Update and Sample.
  void Step() {
    game.Step();
    for (std::size_t i = 0; i < game.clients.size(); ++i) {
      game.clients[i]->SetInput(walkers[i].Walk(*game.clients[i], game.now));
    }
    now = game.now + kPhase;
    player.SetInput(input);
    player.Update(now);
    player.Sample(now, client::Detail::kPosesOnly, samples);
    if (IsPlaying()) Note();
  }
  void Note() {
    const physics::Body& body = game.server.World().ReadBody(player.Welcome().ownBody);
    Truth truth{.centre = game.Centre(body.id), .touchesBody = body.touchesBody};
    std::visit([&](const auto& state) {
      for (const auto& contact : state.contacts) truth.touchesGround = truth.touchesGround || contact.touching;
    }, body.state);
    truths[game.server.World().Tick()] = truth;
  }
  [[nodiscard]] bool IsPlaying() const { return player.ReadState() == client::State::kPlaying; }
  [[nodiscard]] const client::BodySample* Own() const {
    for (const client::BodySample& sample : samples) {
      if (sample.body == player.Welcome().ownBody) return &sample;
    }
    return nullptr;
  }

  Game game;
  client::Client player;
  std::vector<Walker> walkers;
  client::Input input;
  std::vector<client::BodySample> samples;
  std::map<std::uint32_t, Truth> truths;
  double now = 0;
};

TEST(OwnBodyExplore, Trace) {
  const char* path = std::getenv("TRACE");
  if (path == nullptr) GTEST_SKIP();
  std::FILE* file = std::fopen(path, "w");
  Arena arena(true);
  Walker walker(99);
  const int seconds = std::atoi(std::getenv("SECONDS_"));
  for (int i = 0; i < 60 * seconds; ++i) {
    arena.input = walker.Walk(arena.player, arena.now);
    arena.Step();
    const auto* own = arena.Own();
    if (!arena.IsPlaying() || own == nullptr) continue;
    const auto& s = arena.player.ReadStatistics();
    const double server = arena.player.ServerTime(arena.now);
    const Truth& t = arena.truths[arena.game.server.World().Tick()];
    std::fprintf(file, "%.4f %.5f %.5f %.5f  %.4f %.4f %.4f  %.4f %.4f %.4f  %u %.4f %.4f %.4f %d %d  %.3f %.3f %d\n", arena.now, server,
                 arena.player.InterpolationDelay(), s.inputLag, own->pose.centroid.x, own->pose.centroid.y,
                 own->pose.centroid.z, own->lead.x, own->lead.y, own->lead.z, arena.game.server.World().Tick(),
                 t.centre.x(), t.centre.y(), t.centre.z(), t.touchesBody, t.touchesGround, arena.input.moveX,
                 arena.input.moveY, arena.input.jump);
  }
  std::fclose(file);
}

}  // namespace
}  // namespace wobble::test
