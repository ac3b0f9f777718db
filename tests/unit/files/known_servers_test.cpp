// The keys of servers: the first visit notes them, later ones find them, and no line of the file is trusted to be one.
#include "client/files/known_servers.h"

#include <gtest/gtest.h>

#include <fstream>

namespace wobble::files {
namespace {

namespace fs = std::filesystem;
using transport::vestibule::Key;

class KnownServersTest : public testing::Test {
 protected:
  void SetUp() override {
    m_folder = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(m_folder);
  }
  void TearDown() override { fs::remove_all(m_folder); }
  static Key MakeKey(std::uint8_t byte) {
    Key key;
    key.fill(byte);
    return key;
  }
  fs::path m_folder;
};

TEST_F(KnownServersTest, FirstVisitNotesTheKeyAndLaterOnesKeepIt) {
  const KnownServers known(m_folder / "wobble" / "known_servers");
  EXPECT_EQ(known.Find("example.org:7777"), std::nullopt);
  known.Note("example.org:7777", MakeKey(1));
  known.Note("[2001:db8::1]:7777", MakeKey(2));
  known.Note("example.org:7777", MakeKey(3));
  const KnownServers again(known.File());
  EXPECT_EQ(again.Find("example.org:7777"), MakeKey(1));
  EXPECT_EQ(again.Find("[2001:db8::1]:7777"), MakeKey(2));
  EXPECT_EQ(again.Find("example.org:7778"), std::nullopt) << "another port is another server";
}

TEST_F(KnownServersTest, ServersOnThisMachineAreNotNoted) {
  const KnownServers known(m_folder / "known_servers");
  for (const char* address : {"localhost:7777", "127.0.0.1:7777", "127.1.2.3:80", "[::1]:7777"}) {
    known.Note(address, MakeKey(1));
    EXPECT_EQ(known.Find(address), std::nullopt) << address;
  }
  EXPECT_FALSE(fs::exists(known.File()));
}

TEST_F(KnownServersTest, WithoutAFileNothingIsKnownOrNoted) {
  const KnownServers known({});
  known.Note("example.org:7777", MakeKey(1));
  EXPECT_EQ(known.Find("example.org:7777"), std::nullopt);
}

TEST_F(KnownServersTest, FolderThatCannotBeWrittenIsNoError) {
  fs::create_directories(m_folder);
  std::ofstream(m_folder / "file") << "no folder";
  const KnownServers known(m_folder / "file" / "known_servers");
  known.Note("example.org:7777", MakeKey(1));
  EXPECT_EQ(known.Find("example.org:7777"), std::nullopt);
}

// It would be trusted anew, whoever answers.
TEST_F(KnownServersTest, ADamagedKeyIsOneThatNoServerHas) {
  fs::create_directories(m_folder);
  std::ofstream(m_folder / "known_servers") << "example.org:7777 12ab\n";
  EXPECT_EQ(KnownServers(m_folder / "known_servers").Find("example.org:7777"), transport::vestibule::Key{});
}

}  // namespace
}  // namespace wobble::files
