// Whose connection it is, where proxies stand between.
#include "client/gateway/addresses.h"

#include <gtest/gtest.h>

namespace wobble::gateway {
namespace {

using Strings = std::vector<std::string>;

TEST(Addresses, HaveOneSpelling) {
  EXPECT_EQ(SpellAddress("192.0.2.1"), "192.0.2.1");
  EXPECT_EQ(SpellAddress("::ffff:192.0.2.1"), "192.0.2.1");
  EXPECT_EQ(SpellAddress("2001:DB8:0:0::1"), "2001:db8::1");
  for (const char* bad : {"", "here", "192.0.2", "192.0.2.1:80", "[::1]", "::1%lo", " ::1", "192.0.2.01"}) {
    EXPECT_EQ(SpellAddress(bad), "") << bad;
  }
}

TEST(Addresses, ThisMachineIsKnown) {
  for (const char* own : {"localhost", "localhost:8080", "127.0.0.1", "127.9.9.9:1", "[::1]", "[::1]:8080"}) {
    EXPECT_TRUE(IsLoopbackHost(own)) << own;
  }
  for (const char* other : {"", "play.example.org", "localhost.example.org:80", "127.0.0.1.example.org", "192.168.1.5",
                            "[2001:db8::1]:80", ":80", "[", "127.evil"}) {
    EXPECT_FALSE(IsLoopbackHost(other)) << other;
  }
  EXPECT_TRUE(IsLoopback(SpellAddress("::ffff:127.0.0.1")));
  EXPECT_FALSE(IsLoopback(SpellAddress("::ffff:192.0.2.1")));
}

TEST(Addresses, AHouseholdIsOne) {
  EXPECT_EQ(FindHousehold("192.0.2.1"), "192.0.2.1");
  EXPECT_EQ(FindHousehold("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
  EXPECT_EQ(FindHousehold("2001:db8:1:2::9"), "2001:db8:1:2::/64");
}

TEST(Addresses, AStrangersWordIsIgnored) {
  EXPECT_EQ(FindBrowserAddress("192.0.2.1", "198.51.100.7", {}), "192.0.2.1");
  EXPECT_EQ(FindBrowserAddress("192.0.2.1", "198.51.100.7", {"127.0.0.1"}), "192.0.2.1");
}

TEST(Addresses, ATrustedProxysLastWordCounts) {
  const Strings trusted{"127.0.0.1", "10.0.0.2"};
  const auto find = [&](const char* words) { return FindBrowserAddress("127.0.0.1", words, trusted); };
  EXPECT_EQ(find("198.51.100.7"), "198.51.100.7");
  EXPECT_EQ(find("203.0.113.9, 198.51.100.7"), "198.51.100.7") << "what stands before it may be invented";
  EXPECT_EQ(find("127.0.0.1,198.51.100.7 , 10.0.0.2"), "198.51.100.7") << "of two proxies";
  EXPECT_EQ(find("::ffff:198.51.100.7"), "198.51.100.7");
  EXPECT_EQ(find("2001:db8::1"), "2001:db8::1");
  EXPECT_EQ(find("10.0.0.2"), "10.0.0.2") << "the proxy's own visit";
}

TEST(Addresses, AProxyThatNamesNobodyCountsByItself) {
  for (const char* words : {"", " ", ",", "unknown", "198.51.100.7, unknown", "198.51.100.7,", "198.51.100.7:80"}) {
    EXPECT_EQ(FindBrowserAddress("127.0.0.1", words, {"127.0.0.1"}), "127.0.0.1") << words;
  }
}

}  // namespace
}  // namespace wobble::gateway
