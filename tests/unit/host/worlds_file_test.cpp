#include "client/host/worlds_file.h"

#include <gmock/gmock.h>

#include "client/host/check.h"
#include "client/host/make_plan.h"
#include "tests/support/places.h"

namespace wobble::host {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

WorldsFile Parse(const std::string& text, const Environment& environment = {}) {
  return ParseWorlds(text, "/etc/wobble/worlds.toml", environment);
}

std::vector<std::string> OptionsOf(const WorldsFile& file, std::size_t world) {
  return MakeWorldPlan(file, file.worlds[world], "/var").options;
}

TEST(WorldsFile, EveryKindOfMistakeIsNamedWithItsLine) {
  EXPECT_THAT(
      Parse(R"(
colour = "red"
[al]
max_clients = 3
[all]
max_clients = "many"
admin_socket = "a.sock"
pause_after = "1d"
[gateway]
http = 70000
bnd = "::1"
origin = ["http://a", 3]
[[world]]
name = "a b"
prot = 3
[[world]]
rounds = 3
[[world]]
name = "b"
untrained = 1
rotation = []
port = 7777
[[world]]
name = "B"
port = 7777
)")
          .errors,
      ElementsAre("worlds.toml:2: colour is no key here; keys stand in [gateway], [all] or [[world]]",
                  "worlds.toml:3: al is no key here; did you mean all?; keys stand in [gateway], [all] or "
                  "[[world]]",
                  "worlds.toml:6: max_clients = 'many': must be a whole number",
                  "worlds.toml:7: admin_socket is no key here",
                  "worlds.toml:8: pause_after = '1d': must be a number of seconds, or a text such as \"1.5m\"",
                  "worlds.toml:10: http = 70000: must be a whole number from 0 to 65535",
                  "worlds.toml:11: bnd is no key here; did you mean bind?",
                  "worlds.toml:12: origin = [ 'http://a', 3 ]: must be a text or an array of texts",
                  "worlds.toml:13: name = \"a b\": must be letters, digits, - and _, at most 32",
                  "worlds.toml:15: prot is no key here; did you mean port?",
                  "worlds.toml:16: world 2 has no name: name = \"...\" or a scene gives it one",
                  "worlds.toml:20: untrained = 1: must be true or false",
                  "worlds.toml:21: rotation = []: must be a text or an array of texts",
                  "worlds.toml:22: port 7777 of the world b: the world a b has it already",
                  "worlds.toml:23: the name B is too like that of the world at worlds.toml:18: variables cannot "
                  "tell them apart",
                  "worlds.toml:25: port 7777 of the world B: the world a b has it already"));
  EXPECT_THAT(Parse("[all]\nport = \n").errors, ElementsAre(testing::StartsWith("worlds.toml:2: ")));
  EXPECT_THAT(Parse("[all]\nport = 65535\n").errors, ElementsAre("worlds.toml: has no [[world]]"));
  EXPECT_THAT(Parse("[all]\nport = 65535\n[[world]]\nname='a'\n[[world]]\nname='b'\n").errors,
              ElementsAre("worlds.toml:5: port 65536 of the world b: must be at most 65535"));
  EXPECT_THAT(Parse("[[world]]\nname='a'\nops=9100\n[[world]]\nname='b'\nops='9100'\n").errors,
              ElementsAre("worlds.toml:6: ops = '9100': ops of the world a has port 9100 already"));
  EXPECT_THAT(Parse("[gateway]\nhttp=9200\n[[world]]\nname='a'\nops=9100\nrcon='0.0.0.0:9100'\n"
                    "admin_http='127.0.0.1:9200'\n[[world]]\nname='b'\nops='0'\nrcon='127.0.0.2:9300'\n"
                    "admin_http='127.0.0.1:9300'\n")
                  .errors,
              ElementsAre("worlds.toml:6: rcon = '0.0.0.0:9100': ops of the world a has port 9100 already",
                          "worlds.toml:7: admin_http = '127.0.0.1:9200': the page has port 9200 already"));
  EXPECT_THAT(Parse("[[world]]\nname='a'\nbots=2\ninvites='i'\n").errors,
              ElementsAre("worlds.toml:3: bots = 2: the world a asks for invites or tokens, which bots do not have; "
                          "password_file lets them in"));
  EXPECT_THAT(Parse("[[world]]\nname='a'\nbots=2\ninvites='i'\npassword_file='p'\n").errors, IsEmpty());
  EXPECT_THAT(LoadWorlds("/dev/zero", {}).errors, ElementsAre("/dev/zero: must be a file of at most 1 MiB"));
  EXPECT_THAT(LoadWorlds("/nowhere.toml", {}).errors, ElementsAre("/nowhere.toml: there is no such file"));
}

constexpr const char* kTwo = R"(
[all]
max_clients = 9
port = 7800
scene = "pair"
[[world]]
name = "one"
max_clients = 5
password_file = "door"
[[world]]
name = "two-b"
rotation = ["pair", "my/own.toml"]
reset_when_empty = true
state = "/srv/two"
)";

TEST(WorldsFile, WhatIsSaidOfOneWorldWinsOverAllAndPathsAreFromTheFile) {
  const WorldsFile file = Parse(kTwo);
  ASSERT_THAT(file.errors, IsEmpty());
  ASSERT_EQ(file.worlds.size(), 2U);
  EXPECT_EQ(file.worlds[0].port, 7800);
  EXPECT_EQ(file.worlds[1].port, 7801);
  EXPECT_FALSE(file.hasGateway);
  EXPECT_THAT(OptionsOf(file, 0),
              ElementsAre("--bans=/var/one/bans", "--cache=/var/bases", "--max-clients=5",
                          "--password-file=/etc/wobble/door", "--scene=pair", "--state=/var/one", "--name=one"));
  EXPECT_THAT(OptionsOf(file, 1),
              ElementsAre("--bans=/srv/two/bans", "--cache=/var/bases", "--max-clients=9", "--reset-when-empty=true",
                          "--rotation=pair,/etc/wobble/my/own.toml", "--state=/srv/two", "--name=two-b"));
}

TEST(WorldsFile, AVariableWinsInItsPlace) {
  const WorldsFile file = Parse(kTwo, {{"WOBBLE_MAX_CLIENTS", "20"},
                                       {"WOBBLE_PORT", "7900"},
                                       {"WOBBLE_HTTP", "8081"},
                                       {"WOBBLE_BIND", "127.0.0.1"},
                                       {"WOBBLE_ORIGIN", "http://a, http://b"},
                                       {"WOBBLE_THREADS", ""},
                                       {"WOBBLE_WORLD_TWO_B_PORT", "7999"},
                                       {"WOBBLE_WORLD_TWO_B_RESET_WHEN_EMPTY", "no"},
                                       {"WOBBLE_WORLD_ONE_ROTATION", "pair,sumo"}});
  ASSERT_THAT(file.errors, IsEmpty());
  EXPECT_EQ(file.worlds[0].port, 7900);
  EXPECT_EQ(file.worlds[1].port, 7999);
  EXPECT_THAT(OptionsOf(file, 0), Contains("--max-clients=5"));  // its own in the file
  EXPECT_THAT(OptionsOf(file, 0), Contains("--rotation=pair,sumo"));
  EXPECT_THAT(OptionsOf(file, 0), Not(Contains("--scene=pair")));
  EXPECT_THAT(OptionsOf(file, 0), Contains("--gateway-key=/var/gateway.key"));
  EXPECT_THAT(OptionsOf(file, 1), Contains("--max-clients=20"));
  EXPECT_THAT(OptionsOf(file, 1), Contains("--reset-when-empty=false"));
  EXPECT_THAT(OptionsOf(file, 1), Contains("--bind=127.0.0.1"));
  EXPECT_EQ(MakeWorldPlan(file, file.worlds[1], "/var").host, "127.0.0.1");
  EXPECT_EQ(MakeWorldPlan(file, Parse("[[world]]\nname='a'\nbind='fd00::1'\n").worlds[0], "/var").host, "[fd00::1]");
  const GatewayPlan gateway = MakeGatewayPlan(file, "/var");
  EXPECT_EQ(gateway.port, 8081);
  EXPECT_EQ(gateway.bindAddress, "127.0.0.1");
  EXPECT_THAT(gateway.options, ElementsAre("--gateway-key=/var/gateway.key", "--origin=http://a", "--origin=http://b"));
}

TEST(WorldsFile, AWrongVariableIsNamed) {
  EXPECT_THAT(Parse(kTwo, {{"WOBBLE_MAX_PER_ADDRESS", "some"},
                           {"WOBBLE_HTTP", "x"},
                           {"WOBBLE_WORLD_ONE_UNTRAINED", "maybe"},
                           {"WOBBLE_WORLD_ON_PORT", "7"},
                           {"WOBBLE_WORLD_ONE_NAME", "uno"},
                           {"WOBBLE_WORLD_TWO_B_ROTATION", " , "},
                           {"WOBBLE_BOTS", "-1"}})
                  .errors,
              ElementsAre("WOBBLE_BOTS = -1: must be a whole number from 0 to 10000",
                          "WOBBLE_MAX_PER_ADDRESS = some: must be a whole number",
                          "WOBBLE_HTTP = x: must be a whole number from 0 to 65535",
                          "WOBBLE_WORLD_ONE_UNTRAINED = maybe: must be true or false",
                          "WOBBLE_WORLD_TWO_B_ROTATION =  , : must be a text or an array of texts",
                          "WOBBLE_WORLD_ONE_NAME is no key of a world; did you mean WOBBLE_WORLD_ONE_STATE?",
                          "WOBBLE_WORLD_ON_PORT is no key of a world; did you mean WOBBLE_WORLD_ONE_PORT?"));
}

TEST(WorldsFile, WhatAProgramRefusesIsTranslated) {
  const Values values{{"max_clients", {{"5000"}, "worlds.toml:7", "5000"}},
                      {"max", {{"1"}, "worlds.toml:8", "1"}},
                      {"cache", {{"/tmp"}, "", ""}}};
  std::string refused;
  EXPECT_EQ(Translate("--max-clients 5000: must be 1 to 4000", values, "here", refused),
            "worlds.toml:7: max_clients = 5000: must be 1 to 4000");
  EXPECT_EQ(refused, "max_clients");
  EXPECT_EQ(Translate("there is no option --max; did you mean --min? (see wobbled --help)", values, "here", refused),
            "worlds.toml:8: max = 1: there is no option --max; did you mean --min?");
  EXPECT_EQ(refused, "max");
  refused.clear();
  EXPECT_EQ(Translate("bad.toml:3: friction = -1: must be 0 to 10", values, "worlds.toml:3: world a", refused),
            "worlds.toml:3: world a: bad.toml:3: friction = -1: must be 0 to 10");
  EXPECT_EQ(refused, "");
}

TEST(WorldsFile, TheShippedFileHasNoMistake) {
  const WorldsFile file = LoadWorlds(test::FindSource("client/host/worlds.toml"), {});
  EXPECT_THAT(file.errors, IsEmpty());
  EXPECT_TRUE(file.hasGateway);
  EXPECT_EQ(file.worlds.size(), 3U);
}

}  // namespace
}  // namespace wobble::host
