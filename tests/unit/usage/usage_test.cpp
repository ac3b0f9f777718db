#include <gmock/gmock.h>
#include <stdlib.h>

#include "protocol/usage/command_line.h"
#include "protocol/usage/duration.h"
#include "protocol/usage/likeness.h"

namespace wobble::usage {
namespace {

using testing::ElementsAre;

TEST(Likeness, CountsEditsAndFindsTheLikest) {
  EXPECT_EQ(CountEdits("", "abc"), 3U);
  EXPECT_EQ(CountEdits("count", "count"), 0U);
  EXPECT_EQ(CountEdits("cuont", "count"), 1U);  // swapped
  EXPECT_EQ(CountEdits("coun", "count"), 1U);   // left out
  EXPECT_EQ(CountEdits("xyz", "count"), 5U);
  const std::vector<std::string> known{"--count", "--for", "--ramp"};
  EXPECT_EQ(FindLikest("--cout", known), "--count");
  EXPECT_EQ(FindLikest("--fro", known), "--for");
  EXPECT_EQ(FindLikest("--nothing", known), "");
  EXPECT_EQ(FindLikest(std::string(100, 'a'), known), "");
  EXPECT_EQ(Suggest("--rmap", known), "; did you mean --ramp?");
}

// A program with options of each kind.
struct Program {
  Program() {
    app.add_option("--max-clients", clients)->check(CLI::Range(1, 9));
    app.add_option("--server", servers);
    app.add_flag("--untrained", isUntrained);
    AddDuration(app, "--for", seconds, "How long");
    CLI::Option* scene = app.add_option("--scene", word);
    app.add_option("--rotation", words)->delimiter(',')->excludes(scene);
  }

  // Empty: no mistake.
  std::string Run(std::vector<std::string> arguments) {
    const auto all = AddEnvironment(app, std::move(arguments));
    try {
      Parse(app, all);
    } catch (const CLI::ParseError& error) {
      return Explain(app, error, all);
    }
    return "";
  }

  CLI::App app;
  int clients = 0;
  std::vector<std::string> servers, words;
  bool isUntrained = false;
  double seconds = 0;
  std::string word;
};

// A variable of this process for the time of a test.
struct Variable {
  Variable(const char* itsName, const char* text) : name(itsName) { setenv(name, text, 1); }
  ~Variable() { unsetenv(name); }
  const char* name;
};

TEST(CommandLine, EveryOptionIsAVariableAndTheCommandLineWins) {
  const Variable clients("WOBBLE_MAX_CLIENTS", "7"), servers("WOBBLE_SERVER", "a=b:1 c=d:2"),
      untrained("WOBBLE_UNTRAINED", "1"), duration("WOBBLE_FOR", "1.5m"), empty("WOBBLE_SCENE", "");
  Program program;
  EXPECT_EQ(program.Run({}), "");
  EXPECT_EQ(program.clients, 7);
  EXPECT_THAT(program.servers, ElementsAre("a=b:1", "c=d:2"));
  EXPECT_TRUE(program.isUntrained);
  EXPECT_EQ(program.seconds, 90);
  EXPECT_NE(program.app.help().find("WOBBLE_MAX_CLIENTS"), std::string::npos);
  Program other;
  EXPECT_EQ(other.Run({"--max-clients", "3", "--for=2"}), "");
  EXPECT_EQ(other.clients, 3);
  EXPECT_EQ(other.seconds, 2);
}

TEST(CommandLine, AVariableGivesWayToAnOptionThatExcludesIt) {
  const Variable scene("WOBBLE_SCENE", "pair");
  Program program;
  EXPECT_EQ(program.Run({"--rotation", "a,b"}), "");
  EXPECT_EQ(program.word, "");
  const Variable rotation("WOBBLE_ROTATION", "a,b");
  Program both;
  EXPECT_NE(both.Run({}), "");
}

TEST(CommandLine, AMistakeNamesTheVariable) {
  const Variable clients("WOBBLE_MAX_CLIENTS", "70");
  EXPECT_THAT(Program().Run({}), testing::StartsWith("WOBBLE_MAX_CLIENTS: "));
  EXPECT_THAT(Program().Run({"--max-clients=80"}), testing::StartsWith("--max-clients: "));
  const Variable duration("WOBBLE_FOR", "1d");
  Program program;
  EXPECT_THAT(program.Run({"--max-clients=8"}), testing::StartsWith("WOBBLE_FOR: '1d' is no duration"));
  EXPECT_EQ(NameVariables(program.app, "--for 1d: bad; not --format"), "WOBBLE_FOR 1d: bad; not --format");
}

TEST(CommandLine, AnUnknownOptionIsNamedWithTheOneThatItIsLike) {
  EXPECT_EQ(Program().Run({"--max-client", "7"}), "there is no option --max-client; did you mean --max-clients?");
  EXPECT_EQ(Program().Run({"--frobnicate=7"}), "there is no option --frobnicate");
  CLI::App app;
  app.add_subcommand("watch", "");
  app.require_subcommand(0, 1);
  try {
    Parse(app, {"wacth"});
    FAIL();
  } catch (const CLI::ParseError& error) {
    EXPECT_EQ(Explain(app, error, {"wacth"}), "there is no command wacth; did you mean watch?");
  }
}

}  // namespace
}  // namespace wobble::usage
