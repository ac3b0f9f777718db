// `wobble list`: public lists, good and broken, and how worlds are shown; tests/net/lan_test.sh has the network.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/list/public_list.h"
#include "client/list/table.h"

namespace wobble::list {
namespace {

// A file with this text, for as long as it lives.
class ListFile {
 public:
  explicit ListFile(const std::string& text) { std::ofstream(path) << text; }
  ~ListFile() { std::filesystem::remove(path); }
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("wobble_list_" + std::to_string(getpid()) + ".json");
};

// The format itself: tests/unit/command/world_list_test.cpp.
TEST(PublicList, GivesTheWorldsThatProgramsCanReach) {
  const ListFile file(R"({"version": 1, "worlds": [
    {"address": "127.0.0.1:7777", "name": "Ada's", "scene": "arena"},
    {"page": "https://play.example.org/", "name": "in browsers only"},
    {"address": "[2001:db8::1]:7778", "name": "far"}]})");
  std::string error;
  const auto worlds = ReadList(file.path, error);
  EXPECT_EQ(error, "");
  ASSERT_EQ(worlds.size(), 2U);
  EXPECT_EQ(worlds[0].address, "127.0.0.1:7777");
  EXPECT_EQ(worlds[0].resolved.port, 7777);
  EXPECT_EQ(worlds[0].told.name, "Ada's");
  EXPECT_EQ(worlds[0].told.scene, "arena");
  EXPECT_EQ(worlds[1].address, "[2001:db8::1]:7778");
}

TEST(PublicList, WithoutAnAddressOrWithAMistakeIsRefused) {
  std::string error;
  const ListFile file(R"({"version": 1, "worlds": [{"page": "https://play.example.org/", "name": "a"}]})");
  EXPECT_TRUE(ReadList(file.path, error).empty());
  EXPECT_EQ(error, file.path.string() + ": no world of it has an address");
  const ListFile broken(R"({"version": 1, "worlds": [{"address": "a:70000", "name": "a"}]})");
  EXPECT_TRUE(ReadList(broken.path, error).empty());
  EXPECT_NE(error.find("worlds[0].address: 'a:70000'"), std::string::npos) << error;
  EXPECT_TRUE(ReadList("/nowhere/worlds.json", error).empty());
  EXPECT_EQ(error, "'/nowhere/worlds.json' cannot be read");
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
