#include "client/gateway/watched_files.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

namespace wobble::gateway {
namespace {

TEST(WatchedFiles, ChangesAreNoticedOnce) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "watched_files_test";
  std::filesystem::remove(file);
  WatchedFiles watched({"", file.string()});
  EXPECT_FALSE(watched.HaveChanged(0));
  std::ofstream(file) << "first";
  EXPECT_FALSE(watched.HaveChanged(1)) << "it has looked a second ago";
  EXPECT_TRUE(watched.HaveChanged(2));
  EXPECT_FALSE(watched.HaveChanged(4));
  std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) - std::chrono::hours(1));
  EXPECT_TRUE(watched.HaveChanged(6)) << "an older one has taken its place";
  std::filesystem::remove(file);
  EXPECT_TRUE(watched.HaveChanged(8));
  EXPECT_FALSE(watched.HaveChanged(10));
}

}  // namespace
}  // namespace wobble::gateway
