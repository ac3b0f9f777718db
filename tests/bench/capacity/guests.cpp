// Bots as in production: one in 32 decodes, all send and acknowledge. Their rounds are as in `wobble bots`, a fifth of
// the bots at a time, because bots served at once would all wait for the same tick.
#include "tests/bench/capacity/guests.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "protocol/transport/enet_transport.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr unsigned kParts = 5;
constexpr double kRoundHz = 60 * kParts;
constexpr double kJoinsPerSecond = 64;
constexpr double kGoodbyePatience = client::kLongestLeave + 0.5;  // s
// One of so many rounds of a decoding bot is recorded; neighbouring rounds are alike.
constexpr std::uint64_t kKeepEvery = 3;

bots::LoadTestOptions MakeOptions(unsigned players, double ramp, std::uint64_t seed) {
  bots::LoadTestOptions options;
  options.count = players;
  options.ramp = ramp;
  options.seed = seed;
  return options;
}

void SleepUntil(double time) {
  const double seconds = time - ReadWallTime();
  if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace

Guests::Guests(unsigned players, std::uint16_t port, std::uint64_t seed, bots::Script& script,
               const Timetable& timetable, std::atomic<Stage>& stage)
    : m_timetable(timetable),
      m_ramp(players / kJoinsPerSecond),
      m_stage(stage),
      m_runner(
          MakeOptions(players, m_ramp, seed), script,
          [port](auto, std::string& error) { return transport::EnetTransport::Connect("127.0.0.1", port, error); },
          &ReadThreadTime,
          [](std::string_view line) { std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data()); }) {
  m_runner.SetOnShown([this](client::Client& client, std::span<const client::BodySample> shown, double now) {
    if (m_stage == Stage::kShow) Keep(client, shown, now);
  });
}

void Guests::Run(const std::function<bool()>& isStopAsked) {
  const double began = ReadWallTime();
  PlayStages(began, isStopAsked);
  m_guested.figures = m_runner.ReadFigures();
  m_stage = Stage::kLeave;
  double now = ReadWallTime() - began;
  m_runner.Leave(now);
  for (const double end = now + kGoodbyePatience; now < end && !m_runner.HaveAllEnded();) {
    m_runner.RunRound(now, 0);
    SleepUntil(began + now + kParts / kRoundHz);
    now = ReadWallTime() - began;
  }
  m_stage = Stage::kOver;
}

void Guests::PlayStages(double began, const std::function<bool()>& isStopAsked) {
  const double count = m_ramp + m_timetable.settle;
  const double show = count + m_timetable.count;
  double due = 0;
  for (double now = 0; now < show + m_timetable.show && !isStopAsked(); now = ReadWallTime() - began) {
    if (m_stage == Stage::kGather && now >= count) Enter(Stage::kCount);
    if (m_stage == Stage::kCount && now >= show) Enter(Stage::kShow);
    const double late = now - due;
    m_runner.RunRound(now, late, kParts);
    due += (1 + std::floor(late * kRoundHz)) / kRoundHz;
    SleepUntil(began + due);
  }
}

void Guests::Enter(Stage stage) {
  const double now = ReadWallTime();
  const double work = ReadThreadTime();
  const bots::Runner::Progress progress = m_runner.TakeProgress();
  if (stage == Stage::kCount) m_runner.ForgetTimes();
  if (stage == Stage::kShow) {
    m_guested.playing = progress.playing;
    m_guested.work = (work - m_enteredWork) / (now - m_entered);
  }
  m_entered = now;
  m_enteredWork = work;
  m_stage = stage;
}

void Guests::Keep(client::Client& client, std::span<const client::BodySample> shown, double now) {
  if (++m_rounds % kKeepEvery != 0) return;
  m_guested.views.push_back(MakeView(client, shown, now));
}

}  // namespace wobble::bench
