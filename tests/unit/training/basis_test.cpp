// Trained bases: they save bits on play that they were not trained on, fit their limit, and are kept in a folder.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "protocol/codec/encoding/shape_encoder.h"
#include "protocol/snapshot.h"
#include "server/physics/shapes/ball.h"
#include "server/scenes/loader.h"
#include "server/snapshots/capture.h"
#include "server/training/basis_shelf.h"

namespace wobble::server {
namespace {

physics::Blueprint MakeBall(int subdivisions) {
  physics::BallDefinition definition;
  definition.subdivisions = subdivisions;
  definition.material.gas = 330;
  return physics::MakeBall(definition);
}

struct Figures {
  double bits = 0;   // per vertex
  double error = 0;  // RMS, as a share of the size
};

// Measures the first patch over all frames.
Figures Measure(const CapturedBlueprint& blueprint, const RecordedPlay& play, bool usesBasis) {
  protocol::ShapeEncoder encoder;
  std::vector<std::uint8_t> bytes;
  const std::size_t count = protocol::PatchSize(blueprint.rest.size(), 0);
  protocol::PatchModel model =
      protocol::MakePatchModel(blueprint.rest, blueprint.size, blueprint.patches, 0, play.obstacles);
  if (!usesBasis) model.basis = nullptr;
  double squares = 0;
  for (const PlayFrame& frame : play.frames) {
    const auto encoding = encoder.Encode(model, frame.pose, std::span(frame.vertices).first(count),
                                         0.0025F * blueprint.size, protocol::kMaxRecordPayload, bytes);
    EXPECT_TRUE(encoding.fits);
    squares += std::pow(double{encoding.rmsError / blueprint.size}, 2);
  }
  const auto frames = static_cast<double>(play.frames.size());
  return {8 * static_cast<double>(bytes.size()) / frames / static_cast<double>(count), std::sqrt(squares / frames)};
}

TEST(BasisTraining, SavesHalfOfTheBitsOnPlayThatItHasNotSeen) {
  const physics::Blueprint ball = MakeBall(2);
  const Bases bases = TrainBases(ball, RecordPlay(ball, {0, 0, -9.81}, {}, 1));
  ASSERT_EQ(bases.size(), 1U);
  EXPECT_LE(bases[0].size(), protocol::kMaxBasisBytes);
  const CapturedBlueprint captured = CaptureBlueprint(ball, bases);
  ASSERT_NE(captured.patches.at(0).basis, nullptr);

  RecordedPlay play = RecordPlay(ball, {0, 0, -9.81}, {}, 2);
  play.frames.resize(400);
  const Figures with = Measure(captured, play, true), without = Measure(captured, play, false);
  EXPECT_LT(with.bits, 0.5 * without.bits);
  EXPECT_LE(with.error, 0.0025);
  EXPECT_GE(with.error, 0.0023) << "the target is used up";
  play.obstacles.clear();
  EXPECT_LT(with.bits, Measure(captured, play, true).bits) << "what contact suggests";
}

TEST(BasisTraining, LargerBodiesHaveABasisAPatch) {
  const physics::Blueprint ball = MakeBall(3);  // 642 vertices
  const RecordedPlay play = RecordPlay(ball, {0, 0, -9.81}, {}, 1);
  const Bases bases = TrainBases(ball, play);
  ASSERT_EQ(bases.size(), 2U);
  const CapturedBlueprint captured = CaptureBlueprint(ball, bases);
  for (const auto& patch : captured.patches) ASSERT_NE(patch.basis, nullptr);
  EXPECT_LT(Measure(captured, play, true).bits, 0.8 * Measure(captured, play, false).bits);
}

TEST(BasisTraining, ABallHasTheSymmetriesOfAnIcosahedron) {
  EXPECT_EQ(FindSymmetries(CaptureBlueprint(MakeBall(1)).rest).size(), 120U);
  std::vector<protocol::Vector3> rest = CaptureBlueprint(MakeBall(1)).rest;
  rest[3].x += 0.1F;
  EXPECT_LT(FindSymmetries(rest).size(), 5U);
  EXPECT_GE(FindSymmetries(rest).size(), 1U);
}

TEST(BasisTraining, SamePlaySameBytes) {
  const physics::Blueprint ball = MakeBall(1);
  const auto train = [&] { return TrainBases(ball, RecordPlay(ball, {0, 0, -9.81}, {}, 5)); };
  EXPECT_EQ(train(), train());
}

TEST(BasisShelf, KeepsWhatWasTrainedAndMendsWhatIsBroken) {
  scenes::LoadResult loaded = scenes::ParseScene(R"(
[[blueprint]]
name = "ball"
subdivisions = 1
mass = 4
gas = 150
[player]
blueprint = "ball"
)",
                                                 "shelf");
  ASSERT_TRUE(loaded.errors.empty());
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("wobble-shelf-" + std::to_string(::getpid()));
  const auto trained = LoadBases(loaded.scene, folder, 1);
  ASSERT_EQ(trained.size(), 1U);
  ASSERT_EQ(trained[0].size(), 1U);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  ASSERT_EQ(files.size(), 1U);

  const auto written = std::filesystem::last_write_time(files[0]);
  EXPECT_EQ(LoadBases(loaded.scene, folder, 2), trained);
  EXPECT_EQ(std::filesystem::last_write_time(files[0]), written) << "read, not trained again";
  std::ofstream(files[0], std::ios::binary) << "broken";
  EXPECT_EQ(LoadBases(loaded.scene, folder, 1), trained);
  EXPECT_GT(std::filesystem::file_size(files[0]), 1000U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace wobble::server
