// A film shows the recorded ticks, whichever way it comes to them, and a client that watches it sees what they are.
#include "server/recording/film.h"

#include <gmock/gmock.h>

#include "tests/support/game.h"
#include "tests/unit/recording/matches.h"

namespace wobble::recording {
namespace {

using testing::IsEmpty;

class Films : public testing::Test {
 protected:
  void Record(const std::string& scene, std::uint32_t ticks) {
    RecordMatch(scene, ticks, MakeSettings(folder));
    path = folder.List()[0];
    ASSERT_THAT(m_original.Open(path), IsEmpty());
    std::string error;
    const auto original = MakeGround(m_original.ReadHead(), {}, error);
    Replay replay(m_original, *original);
    ASSERT_THAT(replay.Seek(0), IsEmpty());
    do {
      hashes.push_back(original->World().Hash());
    } while (replay.Advance());
  }
  std::unique_ptr<Film> Open(server::TimeSource clock = {}) {
    Recording recording;
    EXPECT_THAT(recording.Open(path), IsEmpty());
    std::string error;
    if (ground == nullptr) ground = MakeGround(recording.ReadHead(), {}, error);
    return std::make_unique<Film>(path, std::move(recording), std::move(clock));
  }
  // Each look at it takes so long, s: as if a tick of the recording did.
  [[nodiscard]] static server::TimeSource MakeSlowClock(double step) {
    return [step, now = 0.0]() mutable { return now += step; };
  }
  void AwaitIndex(const Film& film) const {
    for (int i = 0; i < 1000 && film.Index().MadeUpTo() < film.ReadRecording().LastTick(); ++i) usleep(10'000);
    EXPECT_EQ(film.Index().MadeUpTo(), film.ReadRecording().LastTick());
  }
  void ExpectAsRecorded(const std::string& when) const {
    const std::uint32_t tick = ground->World().Tick();
    EXPECT_EQ(ground->World().Hash(), hashes[tick]) << when << ", tick " << tick;
  }

  Folder folder;
  std::filesystem::path path;
  std::vector<std::uint64_t> hashes;  // by tick
  std::unique_ptr<server::Playground> ground;

 private:
  Recording m_original;
};

TEST_F(Films, ShowTheRecordedTicksAtAnySpeed) {
  Record("curtain", 330);
  const auto film = Open();
  ASSERT_THAT(film->Begin(*ground), IsEmpty());
  for (const double speed : {1.0, 2.5, -1.0, 16.0, -4.0, 0.25, -0.5}) {
    film->SetSpeed(speed);
    film->Play();
    const std::uint32_t before = ground->World().Tick();
    int shown = 0;
    for (; shown < 40 && film->ReadMotion() == Film::Motion::kPlaying; ++shown) {
      film->Advance();
      ExpectAsRecorded("speed " + std::to_string(speed));
    }
    const double way = double{1} * ground->World().Tick() - before;
    EXPECT_NEAR(way, shown * speed, 1 + std::abs(speed)) << "less only at an end";
    EXPECT_THAT(film->TakeFault(), IsEmpty());
  }
}

TEST_F(Films, GoAnywhereAndStepByTick) {
  Record("curtain", 400);
  auto film = Open();
  ASSERT_THAT(film->Begin(*ground), IsEmpty());
  for (int round = 0; round < 2; ++round) {
    for (const double time : {3.2, 0.1, 6.5, 2.0, 1.99, 99.0, -5.0}) {
      film->JumpTo(time);
      EXPECT_NEAR(film->Time(), std::clamp(time, 0.0, film->End()), 0.01);
      ExpectAsRecorded("jump to " + std::to_string(time));
      for (const int step : {-1, -1, 1, 3, -2}) {
        film->StepBy(step);
        ExpectAsRecorded("step");
      }
    }
    EXPECT_EQ(film->ReadMotion(), Film::Motion::kPaused);
    AwaitIndex(*film);  // the second round is with it
  }
  film->JumpTo(99);
  film->SetSpeed(1);
  film->Play();
  EXPECT_EQ(film->Time(), 0) << "from the end it begins again";
}

// Calls of Advance until it has arrived.
int Arrive(Film& film) {
  int calls = 0;
  for (; film.IsSeeking() && calls < 1000; ++calls) film.Advance();
  return calls;
}

// With 3 ms a tick, four of the recording fall into one of the show.
TEST_F(Films, ALongWayTakesManyTicksOfTheShow) {
  Record("curtain", 400);
  auto film = Open(MakeSlowClock(0.003));
  ASSERT_THAT(film->Begin(*ground), IsEmpty());
  film->Pause();
  film->JumpTo(5.5);
  EXPECT_TRUE(film->IsSeeking()) << "an order takes no time that is not its own";
  EXPECT_EQ(film->Time(), 0);
  EXPECT_NEAR(film->Goal(), 5.5, 0.01);
  EXPECT_GE(Arrive(*film), 90 / 5) << "at most two seconds of play less by the index";
  EXPECT_NEAR(film->Time(), 5.5, 0.01);
  ExpectAsRecorded("after a long way");

  film->JumpTo(0.9);
  film->Advance();
  film->JumpTo(film->Goal() + 0.3);
  film->JumpTo(film->Goal() + 0.3);
  EXPECT_NEAR(film->Goal(), 1.5, 0.01) << "from where it will stand";
  film->JumpTo(3.2);
  Arrive(*film);
  EXPECT_NEAR(film->Time(), 3.2, 0.01);
  ExpectAsRecorded("after orders that took one another's place");

  const std::uint32_t before = film->Tick();
  film->StepBy(-1);
  bool hasGathered = false;
  for (int i = 0; i < 1000 && film->IsSeeking(); ++i) {
    hasGathered = hasGathered || film->IsGathering();
    if (i == 3) film->StepBy(-2);
    EXPECT_TRUE(!film->Advance() || !film->IsSeeking()) << "what is gathered is nothing to be shown";
  }
  EXPECT_TRUE(hasGathered);
  EXPECT_EQ(film->Tick(), before - 3);
  ExpectAsRecorded("backwards");
  film->StepBy(-1);
  EXPECT_LE(Arrive(*film), 1) << "gathered already";
  EXPECT_EQ(film->Tick(), before - 4);
  ExpectAsRecorded("backwards again");
}

TEST_F(Films, TheIndexIsMadeOnceAndForItsRecording) {
  Record("arena", 300);
  AwaitIndex(*Open());
  const std::filesystem::path index = path.string() + ".wobidx";
  ASSERT_TRUE(std::filesystem::exists(index));
  const auto made = std::filesystem::last_write_time(index);
  AwaitIndex(*Open());
  EXPECT_EQ(std::filesystem::last_write_time(index), made);
  // One that is torn, or of another recording, is made again.
  Bytes bytes = ReadFile(index);
  bytes.resize(bytes.size() / 2);
  WriteFile(index, bytes);
  AwaitIndex(*Open());
  EXPECT_GT(ReadFile(index).size(), bytes.size());
}

// A way of at least 40 ticks of the show: the server plays one a call, and somebody comes in meanwhile.
TEST_F(Films, TheServerAnswersWhileItIsOnTheWay) {
  Record("curtain", 400);
  test::Game game(scenes::ParseScene(MakeHead("curtain").scene).scene);
  Recording recording;
  ASSERT_THAT(recording.Open(path), IsEmpty());
  ASSERT_EQ(game.server.Show(std::make_unique<Film>(path, std::move(recording), MakeSlowClock(0.006))), "");
  client::Client& first = game.AddClient({.name = "first"});
  game.Run(1);
  ASSERT_EQ(first.ReadState(), client::State::kPlaying);
  Film& film = *game.server.ReadFilm();
  film.Pause();
  film.JumpTo(5.9);
  const std::uint32_t shown = game.server.ShownTick();
  client::Client& second = game.AddClient({.name = "second"});
  while (film.IsSeeking() && second.ReadState() != client::State::kPlaying) game.Run(1.0 / 60);
  EXPECT_TRUE(film.IsSeeking());
  EXPECT_EQ(second.ReadState(), client::State::kPlaying);
  while (film.IsSeeking()) game.Run(1.0 / 60);
  EXPECT_GT(game.server.ShownTick(), shown + 40);
  EXPECT_NEAR(film.Time(), 5.9, 0.01);
  EXPECT_EQ(game.server.Clock().DroppedTicks(), 0U);
}

TEST_F(Films, WatchersReadUpToWhereADamagedOneIsShown) {
  Record("pair", 200);
  const Bytes whole = ReadFile(path);
  WriteFile(path, std::span(whole).first(whole.size() - 60));
  test::Game game(test::LoadShippedScene("pair"));
  Recording recording;
  ASSERT_THAT(recording.Open(path), IsEmpty());
  ASSERT_EQ(game.server.Show(std::make_unique<Film>(path, std::move(recording))), "");
  std::vector<std::string> notices;
  game.AddClient({.name = "watcher"}).OnNotice([&](const std::string& line) { notices.push_back(line); });
  game.Run(0.5);
  EXPECT_THAT(notices, testing::ElementsAre("this recording is damaged: shown up to 3.0 s"));
}

// A server that shows a recording to a client, on virtual time.
TEST_F(Films, AClientSeesWhatIsShown) {
  Record("curtain", 400);
  test::Game game(scenes::ParseScene(MakeHead("curtain").scene).scene);
  Recording recording;
  ASSERT_THAT(recording.Open(path), IsEmpty());
  ASSERT_EQ(game.server.Show(std::make_unique<Film>(path, std::move(recording))), "");
  client::Client& client = game.AddClient({.name = "watcher"});
  game.Run(3);
  ASSERT_EQ(client.ReadState(), client::State::kPlaying);
  EXPECT_EQ(client.Welcome().game, server::kFilm);
  EXPECT_EQ(client.Welcome().ownBody, 0U);
  const auto expectSame = [&](const char* when) {
    game.server.ReadFilm()->Pause();
    game.Run(1.5);
    std::vector<client::BodySample> shown;
    client.Sample(game.now, client::Detail::kVertices, shown);
    EXPECT_EQ(shown.size(), game.server.World().Bodies().size()) << when;
    for (const client::BodySample& each : shown) {
      ASSERT_TRUE(game.HasBody(each.body)) << when;
      physics::Vector3d centre = physics::Vector3d::Zero();
      for (const auto& x : each.vertices) centre += physics::Vector3d(double{x.x}, double{x.y}, double{x.z});
      centre /= static_cast<double>(each.vertices.size());
      physics::Vector3d wanted = physics::Vector3d::Zero();
      physics::VisitVertices(game.server.World().ReadBody(each.body),
                             [&](std::size_t, const physics::Vector3d& x) { wanted += x; });
      wanted /= static_cast<double>(each.vertices.size());
      EXPECT_LT((centre - wanted).norm(), 0.05) << when << ", body " << each.body;
    }
  };
  expectSame("forwards");
  game.server.ReadFilm()->JumpTo(0.1);
  expectSame("before the players joined");
  game.server.ReadFilm()->JumpTo(6);
  expectSame("later");
  game.server.ReadFilm()->SetSpeed(-2);
  game.server.ReadFilm()->Play();
  game.Run(1);
  EXPECT_NEAR(game.server.ReadFilm()->Time(), 4, 0.1);
  expectSame("backwards");
  EXPECT_EQ(client.ReadStatistics().badRecords, 0U);
}

}  // namespace
}  // namespace wobble::recording
