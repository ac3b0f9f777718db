// Recordings that visitors watch: which files may be asked for, and the programs that show them. A script stands for
// wobbled.
#include "client/gateway/films.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <fstream>
#include <functional>

namespace wobble::gateway {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kScript = R"(#!/bin/sh
case "$1" in --list-recordings) echo '{"file": "a.wobrec"}'; echo '{"file": "b.wobrec"}'; exit 0;; esac
case "$2" in *bad*) echo "wobbled: $2 byte 12: the head of a block is damaged" >&2; exit 2;; esac
echo "listening on UDP port 4321 of 127.0.0.1, scene arena"
exec sleep 60
)";

class FilmsTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "wobble-films-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
    std::ofstream(folder / "wobbled") << kScript;
    std::filesystem::permissions(folder / "wobbled", std::filesystem::perms::owner_all);
    for (const char* file : {"a", "b", "c", "d", "e", "bad"}) {
      std::ofstream(folder / (std::string(file) + ".wobrec")) << "x";
    }
    films.emplace(folder, (folder / "wobbled").string(), 8);
  }
  void TearDown() override {
    films.reset();
    std::filesystem::remove_all(folder);
  }
  // The world's time stands still meanwhile.
  [[nodiscard]] bool Await(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000 && !condition(); ++i) {
      usleep(1000);
      films->Turn(now);
    }
    return condition();
  }
  [[nodiscard]] bool AwaitShown(const std::shared_ptr<const Film>& film) {
    return Await([&] { return film->ReadState() == Film::State::kShown; });
  }

  std::filesystem::path folder;
  std::optional<Films> films;
  double now = 100;
};

TEST(RecordingNames, ArePlainNamesOfRecordings) {
  EXPECT_EQ(FindRecordingName("arena-20261124-180000.wobrec"), "arena-20261124-180000.wobrec");
  EXPECT_EQ(FindRecordingName("my%20match%20%C3%A4.wobrec"), "my match \xC3\xA4.wobrec");
  for (const char* wrong :
       {"", ".wobrec", "arena", "arena.wobrec.wobidx", "../a.wobrec", "..%2Fa.wobrec", "a/b.wobrec", ".a.wobrec",
        "a%00.wobrec", "a%0A.wobrec", "a%.wobrec", "a%zz.wobrec", "%2E%2E%2Fa.wobrec"}) {
    EXPECT_EQ(FindRecordingName(wrong), std::nullopt) << wrong;
  }
  std::string tooLong = "a.wobrec";
  tooLong.insert(0, 300, 'a');
  EXPECT_EQ(FindRecordingName(tooLong), std::nullopt);
}

TEST_F(FilmsTest, OneProgramShowsARecordingToAllAndEndsAfterTheLast) {
  auto first = films->Watch("a.wobrec", now);
  EXPECT_EQ(films->Watch("a.wobrec", now), first);
  ASSERT_TRUE(AwaitShown(first)) << first->Reason();
  EXPECT_EQ(first->ReadWorld().server.port, 4321);
  const std::weak_ptr<const Film> left = first;
  first.reset();
  now += 5;
  films->Turn(now);
  EXPECT_FALSE(left.expired()) << "somebody may come back";
  now += 5;
  EXPECT_TRUE(Await([&] { return left.expired(); }));
}

TEST_F(FilmsTest, NoMoreThanAFewAtOnce) {
  std::vector<std::shared_ptr<const Film>> shown;
  for (const char* file : {"a.wobrec", "b.wobrec", "c.wobrec", "d.wobrec"}) shown.push_back(films->Watch(file, now));
  const auto fifth = films->Watch("e.wobrec", now);
  EXPECT_EQ(fifth->ReadState(), Film::State::kOver);
  EXPECT_THAT(fifth->Reason(), HasSubstr("4 other recordings are being watched"));
  EXPECT_EQ(films->Watch("a.wobrec", now), shown[0]);
  shown.clear();
  now += 10;
  films->Turn(now);
  EXPECT_EQ(films->Watch("e.wobrec", now)->ReadState(), Film::State::kStarting);
}

TEST_F(FilmsTest, WhatCannotBeShownSaysWhy) {
  EXPECT_EQ(films->Watch("none.wobrec", now)->Reason(), "there is no such recording here");
  const auto bad = films->Watch("bad.wobrec", now);
  ASSERT_TRUE(Await([&] { return bad->ReadState() == Film::State::kOver; }));
  EXPECT_EQ(bad->Reason(), "the recording byte 12: the head of a block is damaged");
  EXPECT_THAT(bad->Reason(), Not(HasSubstr(folder.string())));
}

TEST_F(FilmsTest, TheListIsWhatTheProgramSays) {
  EXPECT_TRUE(Await([&] { return films->List(now) == R"([{"file": "a.wobrec"},{"file": "b.wobrec"}])"; }))
      << films->List(now);
}

}  // namespace
}  // namespace wobble::gateway
