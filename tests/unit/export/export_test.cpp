// What is exported is what is played: positions in VTK's files to the bit, and a row in the table for each body.
#include <gmock/gmock.h>

#include <cstring>
#include <map>

#include "server/export/csv.h"
#include "server/export/output.h"
#include "server/export/vtk.h"
#include "server/export/walk.h"
#include "tests/unit/recording/matches.h"

namespace wobble::exporting {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Exported : public testing::Test {
 protected:
  Exported() {
    recording::RecordMatch("curtain", 200, recording::MakeSettings(folder));
    EXPECT_THAT(recording.Open(folder.List()[0]), IsEmpty());
    std::string error;
    ground = recording::MakeGround(recording.ReadHead(), {}, error);
    replay = std::make_unique<recording::Replay>(recording, *ground);
  }
  Walked Write(const WalkSettings& settings, FrameWriter& writer) {
    std::string error;
    const auto plan = MakePlan(recording, settings, error);
    EXPECT_TRUE(plan) << error;
    return Walk(recording, *replay, *ground, settings, *plan, writer, [](double, double) { return true; });
  }
  [[nodiscard]] std::string Refuse(const WalkSettings& settings) const {
    std::string error;
    EXPECT_FALSE(MakePlan(recording, settings, error));
    return error;
  }

  recording::Folder folder;
  recording::Recording recording;
  std::unique_ptr<server::Playground> ground;
  std::unique_ptr<recording::Replay> replay;
};

std::string ReadText(const std::filesystem::path& file) {
  const recording::Bytes bytes = recording::ReadFile(file);
  return {bytes.begin(), bytes.end()};
}

TEST_F(Exported, TheTableHasARowABodyAndFrame) {
  const auto file = folder.Path() / "table.csv";
  CsvWriter writer(file, "curtain");
  const Walked walked = Write({.fps = 10}, writer);
  EXPECT_THAT(walked.error + walked.outputError, IsEmpty());
  EXPECT_EQ(walked.frames, 34U);
  std::istringstream lines(ReadText(file));
  std::map<std::string, int> rows;  // by tick
  bool hasTorn = false;
  for (std::string line; std::getline(lines, line);) {
    if (line[0] == '#') continue;
    const auto columns = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
    EXPECT_EQ(columns, 17U) << line;
    if (line.starts_with("time")) continue;
    const auto comma = line.find(',');
    ++rows[line.substr(comma + 1, line.find(',', comma + 1) - comma - 1)];
    hasTorn = hasTorn || !line.ends_with(",0");
  }
  EXPECT_EQ(rows.size(), 34U);
  EXPECT_EQ(rows["0"], 3);
  EXPECT_EQ(rows["198"], 5) << "two players have come";
  EXPECT_TRUE(hasTorn) << "the curtain is cut";
}

TEST_F(Exported, VtkHasThePositionsToTheBit) {
  const auto target = folder.Path() / "series";
  std::filesystem::create_directory(target);
  VtkWriter writer(target, "series");
  const Walked walked = Write({.from = 1, .to = 2, .fps = 20, .bodies = {3}}, writer);
  EXPECT_THAT(walked.error + walked.outputError, IsEmpty());
  EXPECT_EQ(walked.frames, 21U);
  EXPECT_THAT(ReadText(target / "series.pvd"),
              HasSubstr(R"(<DataSet timestep="2" group="" part="0" file="series_00020.vtp"/>)"));
  const std::string text = ReadText(target / "series_00020.vtp");
  const std::string head = R"(Name="Points" NumberOfComponents="3" format="appended" offset=")";
  const auto at = text.find(head);
  ASSERT_NE(at, std::string::npos);
  const std::size_t offset = std::stoul(text.substr(at + head.size()));
  const std::size_t data = text.find("<AppendedData encoding=\"raw\">\n_") + 31 + offset;
  ASSERT_THAT(replay->Seek(120), IsEmpty());
  std::vector<double> wanted;
  physics::VisitVertices(ground->World().ReadBody(3), [&](std::size_t, const physics::Vector3d& x) {
    wanted.insert(wanted.end(), x.begin(), x.end());
  });
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, text.data() + data, sizeof bytes);
  ASSERT_EQ(bytes, wanted.size() * sizeof(double));
  std::vector<double> found(wanted.size());
  std::memcpy(found.data(), text.data() + data + sizeof bytes, bytes);
  EXPECT_EQ(found, wanted);
}

TEST_F(Exported, WhatIsNotThereIsNamed) {
  EXPECT_THAT(Refuse({.from = 9}), HasSubstr("--from 9: must be 0 to 3.333"));
  EXPECT_THAT(Refuse({.from = 2, .to = 1}), HasSubstr("--to 1: must be 2 to 3.333"));
  EXPECT_THAT(Refuse({.fps = 61}), HasSubstr("--fps 61"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Refuse({.from = nan}), HasSubstr("--from nan"));
  EXPECT_THAT(Refuse({.to = nan}), HasSubstr("--to nan"));
  CsvWriter writer(folder.Path() / "table.csv", "curtain");
  EXPECT_EQ(Write({.from = 1, .bodies = {3, 77}}, writer).error,
            "--bodies 77: there is no such body in these frames, which have 1,2,3,4,5");
}

TEST_F(Exported, TimesAreTakenAsTheyAreRead) {
  std::string error;
  EXPECT_EQ(MakePlan(recording, {.to = 0}, error)->frames, 1U) << "as from 1 to 1";
  EXPECT_EQ(MakePlan(recording, {.from = 1, .to = 1}, error)->frames, 1U);
  const auto plan = MakePlan(recording, {.from = 3.37}, error);
  ASSERT_TRUE(plan) << error;
  EXPECT_EQ(plan->firstTick, 200U) << "3.333 s, as somebody rounds it";
}

TEST_F(Exported, AWalkThatIsStoppedFinishesNothing) {
  struct Counter : FrameWriter {
    std::string Add(const Frame& /*frame*/) override { return ++frames, ""; }
    std::string Finish() override { return ++ends, ""; }
    int frames = 0, ends = 0;
  } writer;
  std::string error;
  const WalkSettings settings{.fps = 10, .bodies = {77}};
  const auto stopAt = [&](double end) {
    return Walk(recording, *replay, *ground, settings, *MakePlan(recording, settings, error), writer,
                [end](double time, double) { return time < end; });
  };
  EXPECT_TRUE(stopAt(1).isStopped);
  EXPECT_EQ(writer.frames, 11);
  EXPECT_EQ(writer.ends, 0);
  EXPECT_FALSE(stopAt(3.3).isStopped) << "in its last frame it is done";
}

TEST_F(Exported, AnOutputIsThereWholeOrNotAtAll) {
  const auto target = folder.Path() / "out.csv";
  {
    Output output(target, false);
    EXPECT_THAT(output.Begin(), IsEmpty());
    EXPECT_THAT(Output(target, false).Begin(), HasSubstr("unless another export writes it"));
  }
  EXPECT_FALSE(std::filesystem::exists(target));
  EXPECT_FALSE(std::filesystem::exists(target.string() + ".partial"));
  Output output(target, false);
  EXPECT_THAT(output.Begin(), IsEmpty());
  EXPECT_THAT(output.Commit(), IsEmpty());
  EXPECT_TRUE(std::filesystem::exists(target));
  EXPECT_THAT(Output(target, false).Begin(), HasSubstr("is there already"));
  EXPECT_THAT(Output(target, true, true).Begin(), HasSubstr("is no folder"));
  Output again(target, false, true);
  EXPECT_THAT(again.Begin(), IsEmpty());
  EXPECT_THAT(again.Commit(), IsEmpty());
}

TEST_F(Exported, OnlyASeriesIsReplacedAsAFolder) {
  const auto target = folder.Path() / "series";
  const auto write = [&](bool replaces) {
    Output output(target, true, replaces);
    std::string error = output.Begin();
    if (!error.empty()) return error;
    recording::WriteFile(output.Partial() / "series.pvd", {});
    return output.Commit();
  };
  std::filesystem::create_directory(target);
  EXPECT_THAT(write(false), IsEmpty()) << "an empty one is as good as none";
  EXPECT_THAT(write(false), HasSubstr("is there already: must be new, or --force given"));
  recording::WriteFile(target / "series_00000.vtp", {});
  EXPECT_THAT(write(true), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(target / "series_00000.vtp"));
  recording::WriteFile(target / "diary.txt", {});
  EXPECT_THAT(write(true), HasSubstr("is not replaced: it has diary.txt"));
  EXPECT_TRUE(std::filesystem::exists(target / "diary.txt"));
}

TEST_F(Exported, ARecordingIsNotReplaced) {
  const auto match = folder.List()[0];
  const auto before = recording::ReadFile(match);
  const auto link = folder.Path() / "link";
  std::filesystem::create_symlink(match, link);
  for (const auto& target : {match, link}) {
    EXPECT_THAT(Output(target, false, true).Begin(), HasSubstr("is a recording or a state of wobble")) << target;
  }
  EXPECT_EQ(recording::ReadFile(match), before);
  EXPECT_FALSE(std::filesystem::exists(match.string() + ".partial"));
}

}  // namespace
}  // namespace wobble::exporting
