#include "client/command/world_list.h"

#include <gtest/gtest.h>

namespace wobble::command {
namespace {

std::string FindMistakes(const std::string& json) {
  std::string error;
  EXPECT_EQ(ParseWorldList(json, error), std::nullopt) << json;
  return error;
}

// A list of one world with these fields.
std::string MakeList(const std::string& fields) { return R"({"version": 1, "worlds": [{)" + fields + "}]}"; }

TEST(WorldList, IsReadAndWrittenAgain) {
  std::string error;
  const auto worlds = ParseWorldList(R"({"version": 1, "by": "Ada", "worlds": [
      {"name": "Ada's", "page": "https://play.example.org/?world=sumo", "scene": "sumo", "mood": 3},
      {"name": "plain", "address": "[::1]:7777"}]})",
                                     error);
  ASSERT_TRUE(worlds) << error;
  ASSERT_EQ(worlds->size(), 2U);
  EXPECT_EQ(worlds->at(0).page, "https://play.example.org/?world=sumo");
  EXPECT_EQ(worlds->at(1).address, "[::1]:7777");
  const auto again = ParseWorldList(FormatWorldList(*worlds), error);
  ASSERT_TRUE(again) << error;
  EXPECT_EQ(again->at(0).scene, "sumo");
  EXPECT_EQ(FormatPages(*worlds), R"([{"name":"Ada's","page":"https://play.example.org/?world=sumo","scene":"sumo"}])");
}

TEST(WorldList, NamesEachMistake) {
  EXPECT_EQ(FindMistakes("["), "is no JSON");
  EXPECT_EQ(FindMistakes("\xff"), "is no JSON");
  EXPECT_EQ(FindMistakes(std::string(200'000, '[')), "is no JSON");
  EXPECT_EQ(FindMistakes(std::string(200'000, '[') + std::string(200'000, ']')), "has more than 256 KiB");
  EXPECT_EQ(FindMistakes(std::string(100'000, '[') + std::string(100'000, ']')), "version: must be 1");
  EXPECT_EQ(FindMistakes(R"({"worlds": []})"), "version: must be 1");
  EXPECT_EQ(FindMistakes(R"({"version": 1})"), "worlds: must be an array");
  EXPECT_EQ(FindMistakes(R"({"version": 1, "worlds": [7]})"), "worlds[0]: must be an object");
  EXPECT_EQ(FindMistakes(MakeList(R"("page": 7)")), "worlds[0].page: must be a text");
  EXPECT_EQ(FindMistakes(MakeList("")), "worlds[0]: needs a name; worlds[0]: needs a page or an address");
  EXPECT_EQ(FindMistakes(MakeList(R"("name": "a", "address": "b")")),
            "worlds[0].address: 'b' is no HOST:PORT with a port of 1 to 65535");
  EXPECT_EQ(FindMistakes(MakeList(R"("address": "b:1", "name": ")" + std::string(65, 'x') + "\"")),
            "worlds[0].name: has more than 64 bytes");
  std::string many = R"({"name": "a", "address": "b:1"})";
  for (int i = 0; i < 100; ++i) many += R"(, {"name": "a", "address": "b:1"})";
  EXPECT_EQ(FindMistakes(R"({"version": 1, "worlds": [)" + many + "]}"), "worlds: 101 are more than 100");
}

TEST(WorldList, TakesOnlyPagesOfTheWeb) {
  std::string error;
  for (const char* good : {"http://a", "https://a.example:8080/x?y#z", "http://[::1]:8080/"}) {
    EXPECT_TRUE(ParseWorldList(MakeList(R"("name": "a", "page": ")" + std::string(good) + "\""), error)) << good;
  }
  for (const char* bad : {"javascript:alert(1)", "//a", "ftp://a", "https://", "https:///x", "http://a@b/",
                          "http://a b", "http://a/<b>", "http://a/\\\"", "HTTP://a", "http://é"}) {
    EXPECT_NE(FindMistakes(MakeList(R"("name": "a", "page": ")" + std::string(bad) + "\"")).find(".page:"),
              std::string::npos)
        << bad;
  }
  EXPECT_FALSE(ParseWorldList(MakeList(R"("name": "a", "page": "http://)" + std::string(200, 'a') + "\""), error));
}

TEST(WorldList, NamesAreOneCleanLine) {
  std::string error;
  const auto worlds = ParseWorldList(MakeList(R"("name": "a\u001b[2J\u202eb", "address": "h:1")"), error);
  ASSERT_TRUE(worlds) << error;
  EXPECT_EQ(worlds->at(0).name, "a [2Jb");
}

}  // namespace
}  // namespace wobble::command
