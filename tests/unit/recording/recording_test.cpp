// Recordings: what is played again is what was played, on any number of threads and lanes; damage is found where it is;
// files are their owner's alone and good up to their last whole block; a disk that fails stops no tick.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <bit>
#include <csignal>
#include <functional>

#include "server/recording/excerpt.h"
#include "server/recording/replay.h"
#include "server/recording/verify.h"
#include "tests/support/places.h"
#include "tests/unit/recording/matches.h"

namespace wobble::recording {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Proof Prove(const std::filesystem::path& path, const GroundSettings& settings = {}) {
  return Verify(path, settings, [](auto...) { return true; });
}

// A recording and its replay, at the beginning.
struct Opened {
  explicit Opened(const std::filesystem::path& path) {
    error = recording.Open(path);
    if (error.empty()) ground = MakeGround(recording.ReadHead(), {}, error);
    if (ground == nullptr) return;
    replay = std::make_unique<Replay>(recording, *ground);
    error = replay->Seek(recording.FirstTick());
  }

  Recording recording;
  std::unique_ptr<server::Playground> ground;
  std::unique_ptr<Replay> replay;
  std::string error;
};

class RecordedScene : public testing::TestWithParam<std::string> {};

TEST_P(RecordedScene, PlaysTheSameAgain) {
  const Folder folder;
  const RecorderCounts counts = RecordMatch(GetParam(), 200, MakeSettings(folder), 100);
  EXPECT_EQ(counts.failures, 0U);
  const auto files = folder.List();
  ASSERT_THAT(files, SizeIs(2));
  for (const auto& file : files) {
    for (const GroundSettings settings : {GroundSettings{}, {.threads = 2, .widestPack = 8}, {.widestPack = 1}}) {
      const Proof proof = Prove(file, settings);
      EXPECT_EQ(proof.verdict, Verdict::kIdentical) << proof.words;
      EXPECT_THAT(proof.words, testing::StartsWith("identical"));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, RecordedScene, testing::Values("curtain", "sandbox", "sumo", "crown"),
                         [](const auto& scene) { return scene.param; });

TEST(Recording, AProofThatIsBrokenOffSaysSo) {
  const Folder folder;
  RecordMatch("pair", 200, MakeSettings(folder));
  const auto stopAt = [&](double end) {
    return Verify(folder.List()[0], {}, [end](double time, double) { return time < end; });
  };
  EXPECT_EQ(stopAt(2).verdict, Verdict::kBrokenOff);
  EXPECT_EQ(stopAt(2).words, "broken off at 2.0 s of 3.3 s, identical so far");
  EXPECT_EQ(stopAt(9).verdict, Verdict::kIdentical);
}

TEST(Recording, IsItsOwnersAloneAndNamesNobodyButPlayers) {
  const Folder folder;
  RecordMatch("arena", 70, MakeSettings(folder));
  const auto files = folder.List();
  ASSERT_THAT(files, SizeIs(1));
  EXPECT_EQ(files[0].filename(), "arena-20231114-221320.wobrec");
  struct stat info {};
  ASSERT_EQ(stat(files[0].c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0600U);
}

TEST(Recording, EveryFlippedBitIsFoundAndLocated) {
  const Folder folder;
  RecordMatch("arena", 150, MakeSettings(folder));
  const std::filesystem::path file = folder.List()[0];
  const Bytes whole = ReadFile(file);
  for (std::size_t i = 0; i < whole.size(); i += 1 + whole.size() / 60) {
    Bytes flipped = whole;
    flipped[i] = static_cast<std::uint8_t>(flipped[i] ^ (1U << i % 8));
    WriteFile(file, flipped);
    const Proof proof = Prove(file);
    EXPECT_EQ(proof.verdict, Verdict::kUnreadable) << "bit of byte " << i << ": " << proof.words;
    const auto at = proof.words.find("byte ");
    if (at == std::string::npos) {
      EXPECT_LT(i, 12U) << proof.words;
      continue;
    }
    // The block begins before the flipped bit.
    EXPECT_LE(std::stoul(proof.words.substr(at + 5)), i);
  }
}

TEST(Recording, IsGoodUpToItsLastWholeBlock) {
  const Folder folder;
  RecordMatch("arena", 190, MakeSettings(folder));
  const std::filesystem::path file = folder.List()[0];
  const Bytes whole = ReadFile(file);
  std::uint32_t last = 0;
  for (std::size_t size = 0; size < whole.size(); size += 64) {
    WriteFile(file, std::span(whole).first(size));
    Opened opened(file);
    if (!opened.error.empty()) continue;
    EXPECT_FALSE(opened.recording.IsWhole());
    EXPECT_GE(opened.recording.LastTick(), last);
    EXPECT_EQ(opened.recording.LastTick() % 60, 0U);
    last = opened.recording.LastTick();
    while (size % 512 == 0 && opened.replay->Advance()) {
    }
    EXPECT_FALSE(opened.replay->FirstDifference());
  }
  EXPECT_EQ(last, 180U);
}

// Writes the file anew, with each block's bytes as `change` leaves them.
void ChangeBlocks(const std::filesystem::path& file, const std::function<void(BlockKind, Bytes&)>& change) {
  BlockReader reader;
  ASSERT_THAT(reader.Open(file), IsEmpty());
  Bytes changed = MakeFileHead();
  while (auto block = reader.Next()) {
    change(block->kind, block->bytes);
    const Bytes packed = PackBlock(block->kind, block->bytes);
    changed.insert(changed.end(), packed.begin(), packed.end());
  }
  WriteFile(file, changed);
}

TEST(Recording, ADifferenceIsFoundWithItsTickAndBody) {
  const Folder folder;
  RecordMatch("arena", 200, MakeSettings(folder));
  const std::filesystem::path file = folder.List()[0];
  // The same recording, in which a player came three ticks later.
  ChangeBlocks(file, [](BlockKind kind, Bytes& bytes) {
    if (kind != BlockKind::kSecond) return;
    auto second = FromBytes<Second>(bytes);
    for (TimedEntry& each : second->entries) {
      auto* join = std::get_if<server::JoinEntry>(&each.entry);
      if (join != nullptr && join->client == 2) each.after = static_cast<std::uint16_t>(each.after + 3);
    }
    bytes = ToBytes(*second);
  });
  const Proof proof = Prove(file);
  EXPECT_EQ(proof.verdict, Verdict::kDifferent);
  EXPECT_THAT(proof.words, HasSubstr("different in second 0, from tick 41 on: body ")) << proof.words;
}

// The smallest difference there can be: the last bit of one coordinate of one vertex, at the beginning.
TEST(Recording, OneBitOfOneVertexIsFoundInItsBody) {
  const Folder folder;
  RecordMatch("arena", 260, MakeSettings(folder), 120);
  const std::filesystem::path file = folder.List()[0];  // the second one: "-2" comes before ".wobrec"
  ASSERT_EQ(Prove(file).verdict, Verdict::kIdentical);
  physics::BodyId body = 0;
  ChangeBlocks(file, [&](BlockKind kind, Bytes& bytes) {
    if (kind != BlockKind::kKeyframe) return;
    auto state = FromBytes<server::PlaygroundState>(bytes);
    physics::Body& changed = state->world.bodies.back();  // a player's, in motion
    body = changed.id;
    float& x = std::get<physics::State<float>>(changed.state).positions[7].x();
    x = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^ 1U);
    bytes = ToBytes(*state);
  });
  const Proof proof = Prove(file);
  EXPECT_EQ(proof.verdict, Verdict::kDifferent);
  EXPECT_THAT(proof.words, HasSubstr("different in second 0, from tick 12"));
  EXPECT_THAT(proof.words, HasSubstr(": body " + std::to_string(body)));
}

// One bit of what the recording says of one body at one tick, deep in it.
TEST(Recording, OneBitOfATraceIsFoundAtItsSecondTickAndBody) {
  const Folder folder;
  RecordMatch("arena", 260, MakeSettings(folder));
  const std::filesystem::path file = folder.List()[0];
  Opened played(file);
  ASSERT_THAT(played.replay->Seek(150), IsEmpty());
  std::vector<physics::BodyId> hashed;
  for (; hashed.empty() && played.replay->Advance();) hashed = ListHashed(played.ground->World(), 60);
  const std::uint32_t tick = played.replay->Tick();
  ASSERT_LT(tick, 240U);
  ChangeBlocks(file, [&](BlockKind kind, Bytes& bytes) {
    if (kind != BlockKind::kSecond) return;
    auto second = FromBytes<Second>(bytes);
    if (tick <= second->begin || tick > second->begin + second->traces.size()) return;
    second->traces[tick - 1 - second->begin].hashes.back() ^= 1U;
    bytes = ToBytes(*second);
  });
  const Proof proof = Prove(file);
  EXPECT_EQ(proof.verdict, Verdict::kDifferent);
  EXPECT_EQ(proof.words, "different in second " + std::to_string(tick / 60) + ", from tick " + std::to_string(tick) +
                             " on: body " + std::to_string(hashed.back()));
}

TEST(Recording, GoesToAnyTick) {
  const Folder folder;
  RecordMatch("curtain", 300, MakeSettings(folder), 90);
  for (const auto& file : folder.List()) {
    Opened opened(file);
    ASSERT_THAT(opened.error, IsEmpty());
    std::map<std::uint32_t, std::uint64_t> hashes;
    do {
      hashes[opened.replay->Tick()] = opened.ground->World().Hash();
    } while (opened.replay->Advance());
    for (const std::uint32_t step : {250U, 100U, 35U, 199U, 200U, 91U, 10U, 299U}) {
      const std::uint32_t tick = std::clamp(step, opened.recording.FirstTick(), opened.recording.LastTick());
      EXPECT_THAT(opened.replay->Seek(tick), IsEmpty());
      EXPECT_EQ(opened.replay->Tick(), tick);
      EXPECT_EQ(opened.ground->World().Hash(), hashes[tick]);
    }
    EXPECT_FALSE(opened.replay->FirstDifference());
  }
}

TEST(Recording, AnExcerptIsARecordingOfItsOwn) {
  const Folder folder;
  RecordMatch("curtain", 400, MakeSettings(folder));
  const std::filesystem::path whole = folder.List()[0];
  const std::filesystem::path part = folder.Path() / "part.wobrec";
  ASSERT_THAT(WriteExcerpt(whole, 130, 250, part, {}), IsEmpty());
  const Proof proof = Prove(part);
  EXPECT_EQ(proof.verdict, Verdict::kIdentical) << proof.words;
  Opened excerpt(part);
  ASSERT_THAT(excerpt.error, IsEmpty());
  EXPECT_EQ(excerpt.recording.FirstTick(), 120U) << "whole seconds";
  EXPECT_EQ(excerpt.recording.LastTick(), 300U);
  EXPECT_TRUE(excerpt.recording.IsWhole());
  Opened all(whole);
  ASSERT_THAT(all.replay->Seek(300), IsEmpty());
  while (excerpt.replay->Advance()) {
  }
  EXPECT_EQ(excerpt.ground->World().Hash(), all.ground->World().Hash());
  EXPECT_THAT(WriteExcerpt(whole, 400, 500, part, {}), HasSubstr("has no tick behind 400"));
  EXPECT_THAT(WriteExcerpt(folder.Path() / "nothing.wobrec", 0, 60, part, {}), HasSubstr("nothing.wobrec"));
}

TEST(Recording, FilesOfOthersAreNamed) {
  const Folder folder;
  const auto open = [&](const std::string& name) { return Opened(folder.Path() / name).error; };
  EXPECT_THAT(open("none.wobrec"), HasSubstr("does not exist"));
  WriteFile(folder.Path() / "text.wobrec", ReadFile(test::FindSource("README.md")));
  EXPECT_THAT(open("text.wobrec"), HasSubstr("not of wobble's format"));
  Bytes next = MakeFileHead();
  next[8] = 77;
  WriteFile(folder.Path() / "next.wobrec", next);
  EXPECT_THAT(open("next.wobrec"), HasSubstr("of format 77"));
  Head head = MakeHead("arena");
  head.scene.text = "[[blueprint]]\nname = 3\n";
  Bytes spoiled = MakeFileHead();
  const Bytes block = PackBlock(BlockKind::kHead, ToBytes(head));
  spoiled.insert(spoiled.end(), block.begin(), block.end());
  WriteFile(folder.Path() / "spoiled.wobrec", spoiled);
  EXPECT_THAT(open("spoiled.wobrec"), HasSubstr("scene with mistakes"));
}

TEST(Recording, MeshesAreInTheFile) {
  const Folder folder;
  RecordMatch("mesh_zoo", 70, MakeSettings(folder));
  EXPECT_FALSE(Opened(folder.List()[0]).recording.ReadHead().scene.meshes.empty());
  EXPECT_EQ(Prove(folder.List()[0]).verdict, Verdict::kIdentical);
}

TEST(Recording, RotatesBySize) {
  const Folder folder;
  RecorderSettings settings = MakeSettings(folder);
  settings.maxFileBytes = 5'000;
  RecordMatch("curtain", 600, settings);
  const auto files = folder.List();
  EXPECT_GT(files.size(), 1U);
  for (const auto& file : files) EXPECT_EQ(Prove(file).verdict, Verdict::kIdentical) << Prove(file).words;
}

// A full disk, as a limit of this process: writes beyond it fail.
// As when a world begins anew twice in a moment.
TEST(Recording, AFileWithoutATickIsNotKept) {
  const Folder folder;
  const Head head = MakeHead("pair");
  server::Playground ground(scenes::ParseScene(head.scene).scene, {});
  Recorder recorder(MakeSettings(folder), head, ground);
  recorder.BeginScene(head.scene, ground);
  ground.Step();
  recorder.FollowTick(ground);
  recorder.BeginScene(head.scene, ground);
  recorder.Close();
  EXPECT_EQ(recorder.Counts().files, 1U);
  ASSERT_THAT(folder.List(), SizeIs(1));
  EXPECT_EQ(Opened(folder.List()[0]).recording.LastTick(), 1U);
}

TEST(Recording, AFullDiskStopsNoTick) {
  const Folder folder;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{5'000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const RecorderCounts counts = RecordMatch("curtain", 900, MakeSettings(folder));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_GT(counts.failures, 0U);
  EXPECT_GE(counts.files, 2U) << "it tries again";
  const auto files = folder.List();
  ASSERT_THAT(files, SizeIs(1)) << "what has nothing to play is not left behind";
  const Opened first(files[0]);
  ASSERT_THAT(first.error, IsEmpty());
  EXPECT_EQ(first.recording.LastTick() + counts.lostTicks, 900U);
  EXPECT_THAT(first.recording.Fault(), IsEmpty()) << "what a full disk has left of a block is taken back";
}

TEST(Recording, AFolderThatCannotBeWrittenStopsNoTick) {
  const Folder folder;
  RecorderSettings settings = MakeSettings(folder);
  settings.folder /= "missing";
  const RecorderCounts counts = RecordMatch("arena", 120, settings);
  EXPECT_EQ(counts.failures, 1U);
  EXPECT_EQ(counts.bytes, 0U);
  EXPECT_EQ(counts.lostTicks, 120U);
}

// What is stored of a crowded world is read as it was written.
TEST(Archive, StatesAreReadAsTheyWereWritten) {
  const Head head = MakeHead("curtain");
  server::Playground ground(scenes::ParseScene(head.scene).scene, {});
  while (ground.World().Tick() < 170) {
    ActInMatch(ground);
    ground.Step();
  }
  const Bytes bytes = ToBytes(ground.Capture());
  const auto state = FromBytes<server::PlaygroundState>(bytes);
  ASSERT_TRUE(state);
  EXPECT_EQ(ToBytes(*state), bytes);
  server::Playground other(scenes::ParseScene(head.scene).scene, {});
  ASSERT_THAT(other.Restore(*state), IsEmpty());
  EXPECT_EQ(ToBytes(other.Capture()), bytes) << "a restored playground is captured as the same state";
}

// Whatever is in the place of a state, it is read, refused or played, and nothing breaks.
TEST(Archive, SpoiledStatesAreRefusedOrBorne) {
  const Head head = MakeHead("curtain");
  server::Playground ground(scenes::ParseScene(head.scene).scene, {});
  while (ground.World().Tick() < 120) {
    ActInMatch(ground);
    ground.Step();
  }
  const Bytes bytes = ToBytes(ground.Capture());
  std::uint32_t random = 1;
  int restored = 0;
  for (int i = 0; i < 80; ++i) {
    Bytes spoiled = bytes;
    for (int flips = 0; flips < 1 + i % 3; ++flips) {
      random = random * 1664525 + 1013904223;
      spoiled[random % spoiled.size()] ^= static_cast<std::uint8_t>(1U << (random >> 29));
    }
    if (i % 10 == 0) spoiled.resize(random % spoiled.size());
    const auto state = FromBytes<server::PlaygroundState>(spoiled);
    if (!state) continue;
    server::Playground other(scenes::ParseScene(head.scene).scene, {});
    if (!other.Restore(*state).empty()) continue;
    ++restored;
    for (int tick = 0; tick < 3; ++tick) other.Step();
  }
  EXPECT_GT(restored, 30) << "most bits are of positions and velocities";
}

}  // namespace
}  // namespace wobble::recording
