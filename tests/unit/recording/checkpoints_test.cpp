// Checkpoints: the newest that is whole is found, wherever the others were cut; those of other worlds are named.
#include "server/recording/checkpoints.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "tests/unit/recording/matches.h"

namespace wobble::recording {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class CheckpointsOf : public testing::Test {
 protected:
  CheckpointsOf() : head(MakeHead("curtain")), ground(scenes::ParseScene(head.scene).scene, {}) {}

  void Play(std::uint32_t ticks) {
    for (std::uint32_t i = 0; i < ticks; ++i) {
      ActInMatch(ground);
      ground.Step();
    }
  }
  [[nodiscard]] Checkpoint Capture() const {
    return {.number = 0, .ground = ground.Capture(), .nextClient = 7, .seats = {{2, Identity{1, 2, 3}}}};
  }
  // Saves one after each of these ticks.
  void SaveAfter(std::initializer_list<std::uint32_t> ticks) {
    for (const std::uint32_t tick : ticks) {
      Play(tick - ground.World().Tick());
      Checkpoints checkpoints(folder.Path(), {head});
      EXPECT_THAT(checkpoints.FindNewest().complaints, IsEmpty());
      checkpoints.Save(Capture());
    }
  }
  [[nodiscard]] FoundCheckpoint Find() const { return Checkpoints(folder.Path(), {head}).FindNewest(); }

  Folder folder;
  Head head;
  server::Playground ground;
};

TEST_F(CheckpointsOf, TheNewestIsFoundAndGoesOn) {
  SaveAfter({30, 60, 90, 120});
  EXPECT_THAT(folder.List(), SizeIs(Checkpoints::kKept));
  for (const auto& file : folder.List()) {
    struct stat info {};
    ASSERT_EQ(stat(file.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777U, 0600U);
  }
  const FoundCheckpoint found = Find();
  ASSERT_TRUE(found.checkpoint);
  EXPECT_EQ(found.checkpoint->nextClient, 7U);
  EXPECT_EQ(found.checkpoint->seats, (std::map<server::ClientId, Identity>{{2, Identity{1, 2, 3}}}));
  server::Playground resumed(scenes::ParseScene(head.scene).scene, {});
  ASSERT_THAT(resumed.Restore(found.checkpoint->ground), IsEmpty());
  for (int tick = 0; tick < 40; ++tick) {
    for (server::Playground* each : {&ground, &resumed}) {
      ActInMatch(*each);
      each->Step();
    }
    ASSERT_EQ(resumed.World().Hash(), ground.World().Hash());
  }
}

TEST_F(CheckpointsOf, ATornOneIsNamedAndTheOneBeforeIsTaken) {
  SaveAfter({30, 60});
  const std::filesystem::path newest = folder.Path() / "world-2.wobstate";
  const Bytes whole = ReadFile(newest);
  for (std::size_t size = 0; size < whole.size(); size += 64) {
    WriteFile(newest, std::span(whole).first(size));
    const FoundCheckpoint found = Find();
    ASSERT_TRUE(found.checkpoint) << "cut at " << size;
    EXPECT_EQ(found.checkpoint->ground.world.tick, 30U);
    ASSERT_THAT(found.complaints, SizeIs(1));
    EXPECT_THAT(found.complaints[0], HasSubstr(newest.string()));
  }
  for (std::size_t i = 0; i < whole.size(); i += 97) {
    Bytes flipped = whole;
    flipped[i] ^= 4;
    WriteFile(newest, flipped);
    EXPECT_EQ(Find().checkpoint->ground.world.tick, 30U) << "flipped at " << i;
  }
}

TEST_F(CheckpointsOf, ThoseOfOtherWorldsAreNamedAndStay) {
  SaveAfter({30});
  const auto findAs = [&](std::vector<Head> heads) {
    const FoundCheckpoint found = Checkpoints(folder.Path(), std::move(heads)).FindNewest();
    EXPECT_FALSE(found.checkpoint);
    EXPECT_THAT(found.complaints, SizeIs(1));
    return found.conflict;
  };
  EXPECT_EQ(
      findAs({MakeHead("arena"), MakeHead("pair")}),
      (folder.Path() / "world-1.wobstate").string() +
          " holds a world of curtain, 60 ticks a second, seed 1; this is arena or pair, 60 ticks a second, seed 1");
  Head other = head;
  other.tickHz = 30;
  other.seed = 7;
  EXPECT_THAT(findAs({other}), HasSubstr("seed 1; this is curtain, 30 ticks a second, seed 7"));
  other = head;
  other.scene.text += "\n";
  EXPECT_THAT(findAs({other}), HasSubstr("seed 1, and the scene has changed since"));
  EXPECT_THAT(Checkpoints(folder.Path(), {MakeHead("arena"), head}).FindNewest().conflict, IsEmpty());
  head.version = "the next one";
  EXPECT_TRUE(Find().checkpoint) << "another version of the program goes on";
  EXPECT_THAT(Find().conflict, IsEmpty());
}

TEST_F(CheckpointsOf, AFolderIsOneServersAlone) {
  {
    Checkpoints first(folder.Path(), {head});
    EXPECT_THAT(first.Claim(), IsEmpty());
    EXPECT_EQ(Checkpoints(folder.Path(), {head}).Claim(),
              "in use by another server, process " + std::to_string(getpid()));
  }
  EXPECT_THAT(Checkpoints(folder.Path(), {head}).Claim(), IsEmpty()) << "what a killed one leaves is no lock";
}

// As after a rotation has lost a scene: the older of the two is no reason to lose the newer.
TEST_F(CheckpointsOf, TheNewestDecidesWhetherItIsAnotherWorlds) {
  SaveAfter({30});
  const Head other = MakeHead("arena");
  const auto save = [&](std::vector<Head> heads, std::size_t scene) {
    Checkpoints checkpoints(folder.Path(), std::move(heads));
    EXPECT_TRUE(checkpoints.FindNewest().checkpoint);
    Checkpoint checkpoint = Capture();
    checkpoint.scene = scene;
    checkpoints.Save(std::move(checkpoint));
  };
  save({head, other}, 1);
  EXPECT_THAT(Find().conflict, HasSubstr("holds a world of arena"));
  save({head, other}, 0);
  EXPECT_THAT(Find().conflict, IsEmpty());
  EXPECT_TRUE(Find().checkpoint);
}

TEST_F(CheckpointsOf, ADiskThatIsFullLeavesTheLastOnes) {
  SaveAfter({30});
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1'000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  {
    Checkpoints checkpoints(folder.Path(), {head});
    EXPECT_TRUE(checkpoints.FindNewest().checkpoint);
    Play(5);
    checkpoints.Save(Capture());
    for (int i = 0; i < 200 && checkpoints.Failures() == 0; ++i) usleep(10'000);
    EXPECT_EQ(checkpoints.Failures(), 1U);
    EXPECT_THAT(checkpoints.Error(), HasSubstr("File too large"));
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(Find().checkpoint->ground.world.tick, 30U);
}

TEST_F(CheckpointsOf, AFolderThatIsGoneIsAFailureAndNoMore) {
  Checkpoints checkpoints(folder.Path() / "gone", std::vector{head});
  EXPECT_FALSE(checkpoints.FindNewest().checkpoint);
  checkpoints.Save(Capture());
  for (int i = 0; i < 200 && checkpoints.Failures() == 0; ++i) usleep(10'000);
  EXPECT_EQ(checkpoints.Failures(), 1U);
}

}  // namespace
}  // namespace wobble::recording
