// The own body ahead of the others, in a whole game on virtual time: arena, six bots and a player who walks like a
// person, 100 ms of round trip with jitter and loss. The player's frames lie between the ticks of the server.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/support/game.h"

namespace wobble::test {
namespace {

constexpr double kRadius = 0.5;   // of arena's players, m
constexpr double kPhase = 0.007;  // of a frame after a tick, s
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

// What the player's server and screen have of the own body in one frame.
struct Frame {
  double shownAt = 0;  // world time of the records that are shown, s
  double actsAt = 0;   // and of the moment from which an input of now acts
  physics::Vector3d shown;
  physics::Vector3d lead;
  bool isOwnJump = false;  // the player's own jump begins to be shown: it shall be one
};
struct Truth {
  physics::Vector3d centre;
  bool touchesBody = false;
  bool touchesGround = false;
};

physics::Vector3d ToVector(const protocol::Vector3& v) { return {double{v.x}, double{v.y}, double{v.z}}; }

class Arena {
 public:
  Arena(bool predict, unsigned bots)
      : game(LoadShippedScene("arena")), player(game.network.MakeClient(), {.predict = predict}, 0) {
    game.network.SetConditions({.loss = 0.01, .delay = 0.045, .jitter = 0.01});  // 100 ms of round trip
    for (unsigned i = 0; i < bots; ++i) {
      game.AddClient({.decode = false});
      walkers.emplace_back(i + 1);
    }
  }

  // A tick of the world and a frame of the player.
  void Step() {
    game.Step();
    for (std::size_t i = 0; i < game.clients.size(); ++i) {
      game.clients[i]->SetInput(walkers[i].Walk(*game.clients[i], game.now));
    }
    now = game.now + kPhase;
    player.SetInput(input);
    player.Update(now);
    player.Sample(now, client::Detail::kPosesOnly, samples);
    const client::BodySample* own = Own();
    if (own == nullptr) return;
    NoteTruth(own->body);
    NoteFrame(*own);
  }
  void Run(double seconds) {
    for (const double end = now + seconds; now < end;) Step();
  }
  [[nodiscard]] const client::BodySample* Own() const {
    if (player.ReadState() != client::State::kPlaying) return nullptr;
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
  std::map<std::uint32_t, Truth> truths;  // by tick
  std::vector<Frame> frames;
  double now = 0;

 private:
  void NoteTruth(std::uint32_t number) {
    const physics::Body& body = game.server.World().ReadBody(number);
    Truth truth{.centre = game.Centre(number), .touchesBody = body.touchesBody};
    std::visit(
        [&](const auto& state) {
          for (const auto& contact : state.contacts) truth.touchesGround = truth.touchesGround || contact.touching;
        },
        body.state);
    truths[game.server.World().Tick()] = truth;
  }
  void NoteFrame(const client::BodySample& own) {
    if (input.jump && !m_jumped) m_jumpedAt = now;
    m_jumped = input.jump;
    const double shownAt = player.ServerTime(now) - player.InterpolationDelay();
    frames.push_back({.shownAt = shownAt,
                      .actsAt = player.ServerTime(now) + player.ReadStatistics().inputLag,
                      .shown = ToVector(own.pose.centroid),
                      .lead = ToVector(own.lead),
                      .isOwnJump = now - m_jumpedAt < 4 * kFrame});
  }

  bool m_jumped = false;
  double m_jumpedAt = -1;
};

// Shares of the radius, %.
struct Spread {
  std::vector<double> values;

  [[nodiscard]] double Find(double share) {
    if (values.empty()) return 0;
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
  }
  void Print(const char* name) {
    std::printf("  %-34s %5zu frames, %% of the radius: p50 %6.2f p90 %6.2f p99 %6.2f\n", name, values.size(),
                Find(0.5), Find(0.9), Find(0.99));
  }
};

// Of four starts from rest, between them a second of standing still: the longest time from the input to a frame that
// shows the body moved by half a per cent of its radius.
double FindLatestMotion(bool predict) {
  Arena arena(predict, 0);
  arena.Run(6);
  double latest = 0;
  for (int direction = 0; direction < 4; ++direction) {
    arena.Run(0.8 + 0.003 * direction);
    const physics::Vector3d from = arena.frames.back().shown;
    const double pressedAt = arena.now;
    arena.input.moveX = direction % 2 == 0 ? 1.0F - static_cast<float>(direction) : 0;
    arena.input.moveY = direction % 2 == 0 ? 0 : 2.0F - static_cast<float>(direction);
    do {
      arena.Step();
    } while ((arena.frames.back().shown - from).head<2>().norm() < 0.005 * kRadius && arena.now < pressedAt + 1);
    latest = std::max(latest, arena.now - pressedAt);
    arena.input = {};
    arena.Run(3);
  }
  return latest;
}

TEST(OwnBody, AnswersWithinFiftyMillisecondsOverARoundTripOfAHundred) {
  const double with = FindLatestMotion(true);
  const double without = FindLatestMotion(false);
  std::printf("  from input to motion: %.0f ms, without prediction %.0f ms\n", 1000 * with, 1000 * without);
  EXPECT_LE(with, 0.05);
  EXPECT_GT(without, 0.15);
}

// The two figures that are printed for each phase: the jump of a frame, which is how far it is from where the two
// before lead at constant velocity; and how far the shown place is from where the server has the body once the input of
// now acts.
TEST(OwnBody, InArenaWithSixBotsItsLeadAddsNoJumps) {
  Arena arena(true, 6);
  Walker walker(99);
  for (arena.Run(4); arena.now < 24; arena.Step()) arena.input = walker.Walk(arena.player, arena.now);
  const auto find = [&](double time) {
    const auto tick = static_cast<std::uint32_t>(60 * time);
    const physics::Vector3d a = arena.truths[tick].centre, b = arena.truths[tick + 1].centre;
    return physics::Vector3d(a + (b - a) * (60 * time - tick));
  };
  std::map<std::string, std::array<Spread, 5>> phases;
  for (std::size_t i = 200; i + 20 < arena.frames.size(); ++i) {
    const Frame &frame = arena.frames[i], &last = arena.frames[i - 1], &before = arena.frames[i - 2];
    bool touchesBody = false, touchesGround = false;
    for (double time = frame.shownAt - 0.05; time < frame.actsAt; time += kFrame) {
      const Truth& truth = arena.truths[static_cast<std::uint32_t>(60 * time)];
      touchesBody = touchesBody || truth.touchesBody;
      touchesGround = touchesGround || truth.touchesGround;
    }
    const auto record = [](const Frame& each) { return physics::Vector3d(each.shown - each.lead); };
    if ((record(frame) - record(last)).norm() > 0.4 || frame.isOwnJump) continue;  // put back, or a jump that shall be
    const double percent = 100 / kRadius;
    const physics::Vector3d later = find(frame.actsAt);
    for (const char* phase : {"all", touchesBody     ? "touching others"
                                     : touchesGround ? "touching the ground"
                                                     : "free"}) {
      auto& spreads = phases[phase];
      spreads[0].values.push_back(percent * (frame.lead - 2 * last.lead + before.lead).norm());
      spreads[1].values.push_back(percent * (frame.shown - 2 * last.shown + before.shown).norm());
      spreads[2].values.push_back(percent * (record(frame) - 2 * record(last) + record(before)).norm());
      spreads[3].values.push_back(percent * (frame.shown - later).head<2>().norm());
      spreads[4].values.push_back(percent * (record(frame) - later).head<2>().norm());
    }
  }
  for (auto& [phase, spreads] : phases) {
    std::printf("  %s\n", phase.c_str());
    spreads[0].Print("jump of the lead");
    spreads[1].Print("jump of what is shown");
    spreads[2].Print("jump of the records");
    spreads[3].Print("shown, from where the input acts");
    spreads[4].Print("records, from where the input acts");
  }
  EXPECT_GT(phases["all"][0].values.size(), 900U);
  EXPECT_LE(phases["all"][0].Find(0.99), 5);
  EXPECT_LE(phases["all"][1].Find(0.99), 1.5 * phases["all"][2].Find(0.99));
  EXPECT_LT(phases["all"][3].Find(0.5), phases["all"][4].Find(0.5));
}

}  // namespace
}  // namespace wobble::test
