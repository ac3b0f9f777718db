// Scene and mesh files made to crash or hang the server: each is refused in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "protocol/random.h"
#include "server/scenes/loader.h"
#include "server/scenes/nesting.h"
#include "server/scenes/obj_reader.h"
#include "server/scenes/text_file.h"

namespace wobble::scenes {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

std::string Times(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

std::vector<std::string> Refusals(const std::string& text) { return ParseScene(text, "test.toml").errors; }

TEST(HostileScene, DeepKeysAreRefusedInOneLine) {
  const auto refused = ElementsAre(AllOf(StartsWith("test.toml:2: key = "), HasSubstr("1 to 16 parts")));
  EXPECT_THAT(Refusals("\n" + Times(50000, "a.") + "a = 1"), refused);
  EXPECT_THAT(Refusals("\n[" + Times(50000, "a.") + "a]"), refused);
  EXPECT_THAT(Refusals("\n[[" + Times(50000, "a . ") + "a]]"), refused);
  EXPECT_THAT(Refusals("\nx = {" + Times(50000, "\"a\".'b'.") + "a = 1}"), refused);
  EXPECT_THAT(Refusals("\nx = [1, {" + Times(16, "a.") + "a = 1}]"), refused);
  EXPECT_EQ(Refusals("\n" + Times(50000, "a.") + "a = 1")[0],
            "test.toml:2: key = a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.: must be of 1 to 16 parts between dots");
}

TEST(HostileScene, DeepValuesAreRefusedInOneLine) {
  const auto refused = ElementsAre(AllOf(StartsWith("test.toml:3: value = x = "), HasSubstr("at most 16 deep")));
  EXPECT_THAT(Refusals("\n\nx = " + Times(100000, "[")), refused);
  EXPECT_THAT(Refusals("\n\nx = " + Times(100000, "[") + "1" + Times(100000, "]")), refused);
  EXPECT_THAT(Refusals("\n\nx = " + Times(50000, "{a = ") + "1" + Times(50000, "}")), refused);
  EXPECT_THAT(Refusals("\n\nx = " + Times(20000, "[{a = ") + "1" + Times(20000, "}]")), refused);
  EXPECT_THAT(Refusals("\n\nx = [\"]]]]\", '}}}}', " + Times(17, "[")), refused);
}

TEST(HostileScene, WhatStringsAndCommentsHoldIsNotNesting) {
  const std::string deep = Times(100, "[a.") + Times(100, "]");
  for (const std::string& text : std::vector<std::string>{
           "# " + deep, "x = \"" + deep + "\"", "x = '" + deep + "'", "x = \"\"\"\n\\\"\"\"\\\"" + deep + "\"\"\"\"\"",
           "x = '''\n''" + deep + "'''''", "x = \"\\\\\" # " + deep, "x = [[1.5, 2.5], [3.5, 4.5]]\ny = {a.b = 1.5}"}) {
    EXPECT_FALSE(FindDeepNesting(text)) << text;
  }
  EXPECT_FALSE(FindDeepNesting(Times(15, "a.") + "a = " + Times(16, "[") + Times(16, "]")));
  EXPECT_EQ(FindDeepNesting("x = \"\"\"\n\n\"\"\"\n" + deep)->line, 4);
}

// Strings and comments that begin and end where scan and parser might disagree, about a key that would use up the
// stack.
TEST(HostileScene, NothingHidesDepthFromTheScan) {
  const std::vector<std::string> pieces{"\"", "'",  "\"\"\"", "'''", "\"\"", "''",          "\\",   "#",
                                        "\n", "\r", "\r\n",   "=",   "a",    " ",           "x = ", ",",
                                        "[",  "]",  "{",      "}",   "\v",   "\xE2\x80\xA8"};
  protocol::Random random(5);
  int unseen = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text;
    const auto add = [&](std::uint64_t count) {
      for (; count > 0; --count) text += pieces[random.Next() % pieces.size()];
    };
    add(random.Next() % 8);
    text += Times(20000, "a.") + "a";
    add(random.Next() % 8);
    if (FindDeepNesting(text)) continue;
    ++unseen;
    EXPECT_THAT(Refusals(text), Not(IsEmpty()));  // returns: the parser has not met the key either
  }
  EXPECT_GT(unseen, 100);
}

TEST(HostileScene, LongValuesAndControlCharactersMakeOneShortLine) {
  const auto errors = Refusals("gravity = \"" + Times(100000, "x") + "\"\n\"a\\u001b[2J\\n\\u009b\" = 1\n");
  ASSERT_GE(errors.size(), 2U);
  for (const std::string& error : errors) {
    EXPECT_LT(error.size(), 1100U);
    EXPECT_EQ(error.find_first_of("\x1b\n"), std::string::npos);
    EXPECT_EQ(error.find("\xC2\x9B"), std::string::npos);
  }
}

class HostileFile : public testing::Test {
 protected:
  HostileFile() : folder(std::filesystem::temp_directory_path() / ("wobble_files_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder / "a.toml");
    EXPECT_EQ(::mkfifo((folder / "fifo.toml").c_str(), 0600), 0);
    std::filesystem::create_symlink("fifo.toml", folder / "link.toml");
    std::ofstream(folder / "large") << Times(5 << 20, "\n");
  }
  ~HostileFile() override { std::filesystem::remove_all(folder); }

  std::vector<std::string> ErrorsOfMesh(const std::string& file) const {
    return ParseScene(
               "[[blueprint]]\nname = \"it\"\nkind = \"mesh\"\nfile = \"" + file + "\"\n[player]\nblueprint = \"it\"\n",
               (folder / "scene.toml").string())
        .errors;
  }

  std::filesystem::path folder;
};

TEST_F(HostileFile, ASceneMustBeARegularFileOfOneMebibyte) {
  const auto load = [&](const std::string& name) { return LoadScene((folder / name).string(), folder).errors; };
  const std::string wanted = "a regular file of at most 1 MiB";
  EXPECT_THAT(load("a.toml"),
              ElementsAre("scene file '" + (folder / "a.toml").string() + "' is a directory, not " + wanted));
  EXPECT_THAT(load("fifo.toml"), ElementsAre(HasSubstr("fifo.toml' is a FIFO, not " + wanted)));
  EXPECT_THAT(load("link.toml"), ElementsAre(HasSubstr("link.toml' is a FIFO, not " + wanted)));
  std::filesystem::rename(folder / "large", folder / "large.toml");
  EXPECT_THAT(load("large.toml"), ElementsAre(HasSubstr("large.toml' is larger than " + wanted)));
  EXPECT_THAT(LoadScene("/dev/zero", folder).errors, ElementsAre("scene file '/dev/zero' is a device, not " + wanted));
  EXPECT_THAT(LoadScene((folder / "none.toml").string(), folder).errors, ElementsAre(HasSubstr("cannot be read")));
  EXPECT_EQ(ListScenes(folder).size(), 4U);  // and does not wait for the FIFO's writer
}

TEST_F(HostileFile, AMeshMustBeARegularFileOfFourMebibytes) {
  const std::string wanted = "a regular file of at most 4 MiB";
  EXPECT_THAT(ErrorsOfMesh("/dev/zero"), ElementsAre("scene.toml:4: file = /dev/zero: is a device, not " + wanted +
                                                     ": must be a mesh without mistakes"));
  EXPECT_THAT(ErrorsOfMesh("fifo.toml"), ElementsAre(HasSubstr("file = fifo.toml: is a FIFO, not " + wanted)));
  EXPECT_THAT(ErrorsOfMesh("a.toml"), ElementsAre(HasSubstr("file = a.toml: is a directory, not " + wanted)));
  EXPECT_THAT(ErrorsOfMesh("large"), ElementsAre(HasSubstr("file = large: is larger than " + wanted)));
  EXPECT_THAT(ErrorsOfMesh("."), ElementsAre(HasSubstr("is a directory")));
}

TEST_F(HostileFile, ALongWordOfAMeshIsShownShort) {
  const ObjMesh mesh = ParseObj("v " + Times(100000, "x") + " 0 0\nf " + Times(100000, "y") + "\n");
  ASSERT_EQ(mesh.errors.size(), 2U);
  for (const std::string& error : mesh.errors) EXPECT_LT(error.size(), 120U);
}

}  // namespace
}  // namespace wobble::scenes
