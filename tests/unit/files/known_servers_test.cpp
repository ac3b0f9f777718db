// The keys of servers, as they were at the first visit.
#include "client/files/known_servers.h"

#include <gtest/gtest.h>

namespace wobble::files {
namespace {

using transport::vestibule::Key;

TEST(KnownServers, FindsTheKeyOfTheFirstVisit) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "known" / "servers";
  std::filesystem::remove_all(file.parent_path());
  const KnownServers known(file);
  Key first{}, second{};
  first[0] = 1;
  second[31] = 0xAB;
  EXPECT_FALSE(known.Find("example.org:7777"));
  known.Note("example.org:7777", first);
  known.Note("example.org:7778", second);
  known.Note("example.org:7777", second);  // not the first visit
  EXPECT_EQ(KnownServers(file).Find("example.org:7777"), first);
  EXPECT_EQ(KnownServers(file).Find("example.org:7778"), second);
  EXPECT_FALSE(known.Find("example.org:777"));
  for (const char* here : {"localhost:1", "127.0.0.1:1", "127.9.9.9:1", "[::1]:1"}) {
    known.Note(here, first);
    EXPECT_FALSE(known.Find(here)) << "servers on this machine change their keys as they like";
  }
  std::filesystem::remove_all(file.parent_path());
}

TEST(KnownServers, WithoutAFileNothingIsKnown) {
  const KnownServers nowhere({});
  nowhere.Note("example.org:1", {});
  EXPECT_FALSE(nowhere.Find("example.org:1"));
}

}  // namespace
}  // namespace wobble::files
