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
  Head other = MakeHead("arena");
  EXPECT_FALSE(Checkpoints(folder.Path(), {other}).FindNewest().checkpoint);
  other = head;
  other.tickHz = 30;
  const FoundCheckpoint found = Checkpoints(folder.Path(), {other}).FindNewest();
  EXPECT_FALSE(found.checkpoint);
  ASSERT_THAT(found.complaints, SizeIs(1));
  EXPECT_THAT(found.complaints[0], HasSubstr("of another scene, tick rate or seed"));
  head.version = "the next one";
  EXPECT_TRUE(Find().checkpoint) << "another version of the program goes on";
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
