// `wobble list`: public lists, good and broken, and how worlds are shown; tests/net/lan_test.sh has the network.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/list/public_list.h"
#include "client/list/table.h"

namespace wobble::list {
namespace {

std::string FindError(const std::string& text) {
  std::string error;
  EXPECT_TRUE(ParseList(text, error).empty()) << text;
  return error;
}

TEST(PublicList, HasAddressesAndWhatIsKnown) {
  std::string error;
  const auto worlds = ParseList(
      R"({"worlds": [{"address": "play.example.org:7777", "name": "Ada's", "scene": "arena", "key": "00ff", "more": 1},
                     {"address": "[2001:db8::1]:7778"}]})",
      error);
  EXPECT_EQ(error, "");
  ASSERT_EQ(worlds.size(), 2U);
  EXPECT_EQ(worlds[0].address, "play.example.org:7777");
  EXPECT_EQ(worlds[0].told.name, "Ada's");
  EXPECT_EQ(worlds[0].told.scene, "arena");
  EXPECT_EQ(worlds[0].key, "00ff");
  EXPECT_EQ(worlds[1].address, "[2001:db8::1]:7778");
}

TEST(PublicList, WithAMistakeIsRefusedByEntryAndField) {
  for (const char* text : {"", "[]", "{}", R"({"worlds": 3})", "{\"worlds\": [", "\xFF"}) {
    EXPECT_NE(FindError(text).find("is no list of worlds"), std::string::npos) << text;
  }
  EXPECT_EQ(FindError(R"({"worlds": []})"), "worlds: must be 1 to 1000 entries, not 0");
  EXPECT_EQ(FindError(R"({"worlds": [{"address": "a:1"}, 3]})"), "worlds[1]: must be an object of texts");
  EXPECT_EQ(FindError(R"({"worlds": [{"address": 7}]})"), "worlds[0]: must be an object of texts");
  EXPECT_NE(FindError(R"({"worlds": [{"name": "Ada"}]})").find("worlds[0].address: ''"), std::string::npos);
  EXPECT_NE(FindError(R"({"worlds": [{"address": "a:70000"}]})").find("worlds[0].address: 'a:70000'"),
            std::string::npos);
  nlohmann::json many;
  for (int i = 0; i < 1001; ++i) many["worlds"].push_back({{"address", "a:1"}});
  EXPECT_EQ(FindError(many.dump()), "worlds: must be 1 to 1000 entries, not 1001");
  std::string error;
  EXPECT_TRUE(ReadList("/nowhere/worlds.json", error).empty());
  EXPECT_EQ(error, "/nowhere/worlds.json: cannot be read");
}

std::vector<World> MakeWorlds() {
  World near{.address = "10.9.0.1:7777", .resolved = {}, .ping = 0.0042};
  near.told = {.name = "Zoë\x1b[31m\n", .scene = "sumo", .players = 3, .maxPlayers = 12, .isPrivate = true};
  World silent{.address = "\xc2\x9b[2001:db8::1]:7778", .resolved = {}};
  return {near, silent};
}

TEST(List, IsATableForPeopleWithoutWhatATerminalObeys) {
  EXPECT_EQ(WriteTable(MakeWorlds()),
            "NAME       ADDRESS              SCENE  PLAYERS       PING\n"
            "Zoë [31m   10.9.0.1:7777        sumo   3/12, closed  4.2 ms\n"
            "-           [2001:db8::1]:7778  -      -             -\n");
}

TEST(List, IsAnArrayForPrograms) {
  const auto list = nlohmann::json::parse(WriteJson(MakeWorlds()));
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0]["players"], 3);
  EXPECT_EQ(list[0]["max_players"], 12);
  EXPECT_EQ(list[0]["closed"], true);
  EXPECT_EQ(list[0]["ping_ms"], 4.2);
  EXPECT_EQ(list[0]["key"], nullptr);
  EXPECT_EQ(list[1]["address"], " [2001:db8::1]:7778") << "a control character is a space";
  for (const char* unknown : {"name", "scene", "version", "players", "ping_ms"}) EXPECT_EQ(list[1][unknown], nullptr);
  EXPECT_EQ(WriteJson({}), "[]\n");
}

}  // namespace
}  // namespace wobble::list
