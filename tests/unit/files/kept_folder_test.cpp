// Blueprints in files: found again by the same server, apart from other servers, never trusted.
#include "client/files/kept_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace wobble::files {
namespace {

namespace fs = std::filesystem;

class KeptFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    m_folder = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(m_folder);
  }
  void TearDown() override { fs::remove_all(m_folder); }
  static std::vector<std::uint8_t> MakeBytes(std::size_t size, std::uint8_t value) {
    return std::vector<std::uint8_t>(size, value);
  }
  static void Keep(const KeptFolder& kept, const std::vector<std::uint8_t>& bytes) {
    kept.Keep(protocol::HashBytes(bytes), bytes);
  }
  [[nodiscard]] std::vector<fs::path> ListFiles() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(m_folder)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    return files;
  }
  fs::path m_folder;
};

TEST_F(KeptFolderTest, FindsAgainWhatTheSameServerSent) {
  const KeptFolder kept(m_folder, "example.org:7777");
  EXPECT_TRUE(kept.Load()->empty()) << "no folder yet";
  Keep(kept, MakeBytes(5000, 1));
  Keep(kept, MakeBytes(6000, 2));
  const auto loaded = KeptFolder(m_folder, "example.org:7777").Load();
  ASSERT_EQ(loaded->size(), 2U);
  EXPECT_EQ(loaded->at(0).hash, protocol::HashBytes(loaded->at(0).bytes));
  EXPECT_TRUE(KeptFolder(m_folder, "example.org:7778").Load()->empty()) << "another server";
}

TEST_F(KeptFolderTest, AServersNameLeadsToNoOtherFolder) {
  for (const char* name : {"../../x", "/etc", "..", ".", "", "a/b\\c\n"}) {
    Keep(KeptFolder(m_folder, name), MakeBytes(100, 1));
  }
  for (const fs::path& file : ListFiles()) EXPECT_EQ(file.parent_path().parent_path(), m_folder);
  EXPECT_EQ(ListFiles().size(), 6U);
}

TEST_F(KeptFolderTest, PassesOverSpoiltFiles) {
  const KeptFolder kept(m_folder, "s");
  Keep(kept, MakeBytes(5000, 1));
  for (const fs::path& file : ListFiles()) std::ofstream(file, std::ios::app) << "more";
  EXPECT_TRUE(kept.Load()->empty());
}

TEST_F(KeptFolderTest, RemovesTheOldestBeyondWhatAHelloHolds) {
  const KeptFolder kept(m_folder, "s");
  for (std::size_t i = 0; i < protocol::kMaxKeptBlueprints + 5; ++i) Keep(kept, MakeBytes(100 + i, 1));
  EXPECT_EQ(ListFiles().size(), protocol::kMaxKeptBlueprints);
  for (int i = 0; i < 12; ++i) Keep(kept, MakeBytes(protocol::kMaxBlueprintBytes, static_cast<std::uint8_t>(i)));
  std::size_t bytes = 0;
  const auto loaded = kept.Load();
  for (const client::KeptBlueprint& each : *loaded) bytes += each.bytes.size();
  EXPECT_LE(bytes, protocol::kMaxKeptBytes);
  EXPECT_GE(loaded->size(), 7U);
}

TEST_F(KeptFolderTest, AFolderThatCannotBeWrittenIsNoError) {
  const KeptFolder none({}, "s");
  Keep(none, MakeBytes(100, 1));
  EXPECT_TRUE(none.Load()->empty());
  std::ofstream(m_folder) << "a file where the folder should be";
  const KeptFolder blocked(m_folder, "s");
  Keep(blocked, MakeBytes(100, 1));
  EXPECT_TRUE(blocked.Load()->empty());
}

}  // namespace
}  // namespace wobble::files
