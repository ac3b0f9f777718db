#include "client/command/lan_address.h"

#include <gtest/gtest.h>

namespace wobble::command {
namespace {

using Addresses = std::vector<std::string>;

TEST(LanAddress, PrivateIpv4ComesFirstAndTunnelsLast) {
  const Addresses chosen = ChooseLanAddresses({{.interface = "tun0", .address = "10.8.0.2", .isPointToPoint = true},
                                               {.interface = "eth0", .address = "2001:db8::7"},
                                               {.interface = "eth1", .address = "203.0.113.9"},
                                               {.interface = "wlan0", .address = "172.31.0.4"},
                                               {.interface = "eth0", .address = "192.168.1.5"}});
  EXPECT_EQ(chosen, (Addresses{"172.31.0.4", "192.168.1.5", "203.0.113.9", "2001:db8::7", "10.8.0.2"}));
}

TEST(LanAddress, WhatFriendsCannotReachIsLeftOut) {
  EXPECT_EQ(ChooseLanAddresses({{.interface = "lo", .address = "127.0.0.1"},
                                {.interface = "lo", .address = "::1"},
                                {.interface = "eth0", .address = "169.254.3.4"},
                                {.interface = "eth0", .address = "fe80::1"},
                                {.interface = "eth1", .address = "192.168.1.5", .isUp = false},
                                {.interface = "docker0", .address = "172.17.0.1"},
                                {.interface = "br-0a1b2c3d4e5f", .address = "172.18.0.1"},
                                {.interface = "virbr0", .address = "192.168.122.1"},
                                {.interface = "eth0", .address = "no address"}}),
            Addresses{});
  // A bridge that a person made has the network's own address.
  for (const char* name : {"br0", "br-lan"}) {
    EXPECT_EQ(ChooseLanAddresses({{.interface = name, .address = "192.168.1.5"}}), Addresses{"192.168.1.5"}) << name;
  }
}

TEST(LanAddress, OnlyTheAddressThatIsListenedAtCounts) {
  EXPECT_EQ(FindLanAddresses("192.168.1.5"), Addresses{"192.168.1.5"});
  EXPECT_EQ(FindLanAddresses("127.0.0.1"), Addresses{});
  EXPECT_EQ(FindLanAddresses("::1"), Addresses{});
  for (const std::string& each : FindLanAddresses("0.0.0.0")) EXPECT_EQ(each.find(':'), std::string::npos) << each;
}

TEST(LanAddress, UrlsHaveBracketsAndNoUsualPort) {
  EXPECT_EQ(MakePageUrl("http", "192.168.1.5", 8080), "http://192.168.1.5:8080/");
  EXPECT_EQ(MakePageUrl("http", "192.168.1.5", 80), "http://192.168.1.5/");
  EXPECT_EQ(MakePageUrl("https", "2001:db8::7", 443), "https://[2001:db8::7]/");
  EXPECT_EQ(MakePageUrl("https", "192.168.1.5", 80), "https://192.168.1.5:80/");
}

}  // namespace
}  // namespace wobble::command
