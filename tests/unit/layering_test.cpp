// Who may include whom: every #include line under server/, protocol/ and client/ against one table.
//
// The longest matching path of the table decides. What it can show is what a line names: that a folder reaches only
// into the folders and packages it may, that own files are named from the root, and that no clock, file or log is used
// where time is a parameter. It cannot see through an included header. So the third law (physics types meet protocol
// types in session and capture alone) is tested as: no other file under server/ names a physics header together with a
// protocol header that has poses, vertices or messages in it. The headers that only carry numbers and bytes (limits,
// snapshot, acknowledgement, transport) do not count: server.cpp, which calls all five stages, must know both. Nor does
// physics/parallel.h, which is a loop and no type.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::test {
namespace {

using Strings = std::vector<std::string>;

struct Layer {
  std::string path;     // a folder with its '/', or one file
  Strings own;          // prefixes of own includes
  Strings packages;     // prefixes of angle includes beside the standard library
  Strings notStandard;  // standard headers refused here
};

const Strings kClockFileLog{"chrono", "ctime", "iostream", "fstream", "filesystem", "cstdio", "thread"};
// Also what Emscripten's library has not got.
const Strings kPortable{"chrono", "ctime",  "iostream", "fstream",    "filesystem", "cstdio",
                        "thread", "ranges", "format",   "stop_token", "concepts",   "source_location"};
const Strings kClock{"chrono", "ctime"};
const Strings kSystem{"arpa/",   "fcntl.h",  "netdb.h", "netinet/", "poll.h",    "pthread.h",
                      "sched.h", "signal.h", "spawn.h", "sys/",     "termios.h", "unistd.h"};

Strings Join(Strings first, const Strings& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

// architecture.md's table, the most particular path first.
const std::vector<Layer> kLayers{
    {"server/physics/", {"server/physics/"}, {"Eigen/", "immintrin.h", "oneapi/tbb", "tbb/"}, kClockFileLog},
    {"server/scenes/", {"server/scenes/", "server/physics/"}, {"toml++/"}, kClock},
    {"server/main.cpp", {"server/", "protocol/"}, Join(kSystem, {"CLI/", "fmt/", "nlohmann/", "spdlog/"}), {}},
    {"server/options.", {"server/", "protocol/version.h"}, {"CLI/", "fmt/"}, kClock},
    // Only it waits, on a thread of its own; when it is asked to call is the business of fleet_duty.
    {"server/ops/agones.", {"server/ops/"}, {"httplib.h", "signal.h", "spdlog/"}, {}},
    {"server/ops/fleet_duty.", {"server/ops/"}, {}, kClockFileLog},
    {"server/ops/",
     {"server/", "protocol/"},
     Join(kSystem, {"fmt/", "httplib.h", "nlohmann/", "prometheus/", "spdlog/"}),
     kClock},
    // What comes out of the engine comes out in Eigen's types, and a body's rotation is found with its solvers.
    {"server/capture.", {"server/", "protocol/"}, {"Eigen/"}, kClock},
    // Bases are eigenvectors of what play does to a body.
    {"server/basis_", {"server/", "protocol/"}, {"Eigen/", "fmt/", "spdlog/"}, kClock},
    {"server/",
     {"server/", "protocol/acknowledgement.h", "protocol/bits.h", "protocol/geometry.h", "protocol/limits.h",
      "protocol/messages", "protocol/pose.h", "protocol/shape_codec.h", "protocol/snapshot.h",
      "protocol/transport/transport.h", "protocol/version.h"},
     {"fmt/", "nlohmann/", "oneapi/tbb", "prometheus/", "spdlog/", "tbb/"},
     kClock},
    {"protocol/transport/", {"protocol/"}, Join(kSystem, {"enet/", "zlib.h"}), kClockFileLog},
    {"protocol/", {"protocol/"}, {"flatbuffers/"}, kPortable},
    {"client/bots/", {"client/", "protocol/"}, Join(kSystem, {"CLI/", "lua.hpp", "nlohmann/"}), {}},
    {"client/tool/", {"client/", "protocol/"}, Join(kSystem, {"CLI/"}), {}},
    {"client/terminal/", {"client/", "protocol/"}, Join(kSystem, {"CLI/"}), {}},
    {"client/web/", {"client/", "protocol/"}, Join(kSystem, {"CLI/", "boost/", "emscripten", "zlib.h"}), {}},
    {"client/health/", {"client/"}, {"CLI/", "httplib.h"}, {}},
    {"client/link/", {"client/", "protocol/"}, Join(kSystem, {"CLI/"}), {}},
    // A developer copies it: what it includes is all there is to know.
    {"client/example.cpp", {"client/client.h", "protocol/transport/enet_transport.h"}, {}, {}},
    {"client/main.cpp", {"client/", "protocol/"}, Join(kSystem, {"CLI/", "nlohmann/"}), {}},
    {"client/play/", {"client/", "protocol/"}, Join(kSystem, {"CLI/", "nlohmann/"}), {}},
    {"client/",
     {"client/", "protocol/acknowledgement.h", "protocol/basis.h", "protocol/bits.h", "protocol/geometry.h",
      "protocol/limits.h", "protocol/messages", "protocol/pose.h", "protocol/shape_codec.h", "protocol/snapshot.h",
      "protocol/transport/transport.h"},
     {},
     kPortable},
};

// Where the third law lets physics and protocol types meet.
const Strings kMeetingPlaces{"server/session.", "server/capture.", "server/main.cpp", "server/ops/", "server/scenes/"};
const Strings kTypedProtocolHeaders{"protocol/geometry.h", "protocol/messages", "protocol/pose.h",
                                    "protocol/shape_codec.h"};

bool BeginsWithOneOf(const std::string& text, const Strings& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string& prefix) { return text.rfind(prefix, 0) == 0; });
}

// Those of C++ alone have neither folder nor ending.
bool IsStandardHeader(const std::string& name) { return name.find_first_of("/.") == std::string::npos; }

std::string Trim(const std::string& text) {
  const auto isSpace = [](unsigned char c) { return std::isspace(c) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), isSpace);
  return {begin, std::find_if_not(text.rbegin(), std::make_reverse_iterator(begin), isSpace).base()};
}

// What follows #include on this line; empty when it is another line.
std::string FindIncludeTarget(const std::string& line) {
  const std::string directive = Trim(line);
  if (directive.empty() || directive[0] != '#') return "";
  constexpr std::string_view kInclude = "include";
  const std::string rest = Trim(directive.substr(1));
  return rest.rfind(kInclude, 0) == 0 ? Trim(rest.substr(kInclude.size())) : "";
}

// Why this include is not allowed there; empty when it is.
std::string FindReason(const Layer& layer, char opening, const std::string& name) {
  if (opening == '"') {
    if (name.find('/') == std::string::npos) return "is not written from the root";
    return BeginsWithOneOf(name, layer.own) ? "" : "is a layer that " + layer.path + " may not reach into";
  }
  if (IsStandardHeader(name)) {
    const bool refused = std::find(layer.notStandard.begin(), layer.notStandard.end(), name) != layer.notStandard.end();
    return refused ? "has no place in " + layer.path : "";
  }
  return BeginsWithOneOf(name, layer.packages) ? "" : "is not a package of " + layer.path;
}

// One line "file:line: ..." for each offence in the text of the file at `path`, relative to the root.
Strings FindOffences(const std::string& path, const std::string& text) {
  const auto layer =
      std::find_if(kLayers.begin(), kLayers.end(), [&](const Layer& each) { return path.rfind(each.path, 0) == 0; });
  if (layer == kLayers.end()) return {path + ":1: no layer is known for this file"};
  Strings offences;
  bool hasPhysics = false, hasTyped = false;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string target = FindIncludeTarget(line);
    if (target.empty()) continue;
    const auto report = [&](const std::string& what) {
      offences.push_back(path + ":" + std::to_string(number) + ": " + what);
    };
    const std::size_t closing = target.find(target[0] == '<' ? '>' : '"', 1);
    if ((target[0] != '<' && target[0] != '"') || closing == std::string::npos) {
      report(target + " cannot be checked");
      continue;
    }
    const std::string name = target.substr(1, closing - 1);
    const std::string reason = FindReason(*layer, target[0], name);
    if (!reason.empty()) report(name + " " + reason);
    const bool isPhysics = name.rfind("server/physics/", 0) == 0 && name != "server/physics/parallel.h";
    hasPhysics |= isPhysics;
    const bool typed = BeginsWithOneOf(name, kTypedProtocolHeaders);
    hasTyped |= typed;
    const bool mayMeet = path.rfind("server/", 0) != 0 || BeginsWithOneOf(path, kMeetingPlaces);
    const bool meets = hasPhysics && hasTyped && (typed || isPhysics);
    if (!mayMeet && meets) report(name + " makes physics meet protocol outside session and capture");
  }
  return offences;
}

bool IsSource(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".h" || extension == ".cpp" || extension == ".inl";
}

std::string ReadWhole(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Layering, EveryIncludeKeepsToTheTable) {
  const std::filesystem::path root(WOBBLE_SOURCE_DIR);
  int files = 0;
  for (const char* folder : {"server", "protocol", "client"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string path = entry.path().lexically_relative(root).generic_string();
      if (!entry.is_regular_file() || !IsSource(entry.path()) || path.find("node_modules") != std::string::npos)
        continue;
      ++files;
      for (const std::string& offence : FindOffences(path, ReadWhole(entry.path()))) ADD_FAILURE() << offence;
    }
  }
  EXPECT_GT(files, 15) << "is " << root << " the source?";
}

struct Case {
  const char* path;
  const char* text;
  Strings offences;  // the beginning of each
};

// The checker itself: each law broken once is reported at its line, and what is allowed is not.
TEST(Layering, TheCheckerSeesEachOffence) {
  const std::vector<Case> cases{
      {"server/physics/world.cpp",
       "#include \"server/physics/world.h\"\n#include <Eigen/Core>\n#include <vector>\n",
       {}},
      {"server/physics/world.cpp",
       "// a\n#include \"protocol/limits.h\"\n",
       {"server/physics/world.cpp:2: protocol/limits.h"}},
      {"server/physics/world.cpp", "#include \"server/session.h\"\n", {"server/physics/world.cpp:1: server/session.h"}},
      {"server/physics/world.cpp",
       "#include <spdlog/spdlog.h>\n#include <chrono>\n",
       {"server/physics/world.cpp:1: spdlog/spdlog.h", "server/physics/world.cpp:2: chrono"}},
      {"server/physics/world.cpp", "#include \"world.h\"\n", {"server/physics/world.cpp:1: world.h is not written"}},
      {"server/physics/world.cpp", "  #  include <server/physics/world.h>\n", {"server/physics/world.cpp:1: server/"}},
      {"server/physics/world.cpp", "#include WORLD\n", {"server/physics/world.cpp:1: WORLD cannot"}},
      {"server/physics/world.cpp", "// #include \"protocol/limits.h\"\n", {}},
      {"server/scenes/loader.cpp", "#include \"server/physics/world.h\"\n#include <toml++/toml.h>\n", {}},
      {"server/scenes/loader.cpp", "#include \"server/server.h\"\n", {"server/scenes/loader.cpp:1: server/server.h"}},
      {"server/server.cpp", "#include <enet/enet.h>\n", {"server/server.cpp:1: enet/enet.h"}},
      {"server/server.cpp", "#include \"client/client.h\"\n", {"server/server.cpp:1: client/client.h"}},
      {"server/server.cpp", "#include \"protocol/transport/enet_transport.h\"\n", {"server/server.cpp:1: protocol/"}},
      {"server/server.cpp", "#include <httplib.h>\n", {"server/server.cpp:1: httplib.h"}},
      {"server/ops/agones.cpp", "#include <httplib.h>\n#include <chrono>\n#include <thread>\n", {}},
      {"server/ops/fleet_duty.cpp", "#include <chrono>\n", {"server/ops/fleet_duty.cpp:1: chrono"}},
      {"server/main.cpp", "#include \"protocol/transport/enet_transport.h\"\n#include <chrono>\n", {}},
      {"server/server.cpp", "#include \"server/physics/world.h\"\n#include \"protocol/snapshot.h\"\n", {}},
      {"server/server.cpp",
       "#include \"server/physics/world.h\"\n#include \"protocol/pose.h\"\n",
       {"server/server.cpp:2: protocol/pose.h makes physics meet"}},
      {"server/server.h",
       "#include \"protocol/messages.h\"\n#include <vector>\n#include \"server/physics/world.h\"\n",
       {"server/server.h:3: server/physics/world.h makes physics meet"}},
      {"server/capture.cpp", "#include \"server/physics/world.h\"\n#include \"protocol/pose.h\"\n", {}},
      {"protocol/pose.cpp", "#include \"server/physics/world.h\"\n", {"protocol/pose.cpp:1: server/"}},
      {"protocol/pose.cpp",
       "#include <Eigen/Core>\n#include <ranges>\n",
       {"protocol/pose.cpp:1: Eigen", "protocol/pose.cpp:2: ranges"}},
      {"protocol/snapshot.cpp", "#include <enet/enet.h>\n", {"protocol/snapshot.cpp:1: enet"}},
      {"protocol/transport/enet_transport.cpp", "#include <enet/enet.h>\n#include \"protocol/limits.h\"\n", {}},
      {"client/client.cpp", "#include \"server/physics/world.h\"\n", {"client/client.cpp:1: server/"}},
      {"client/client.cpp", "#include <lua.hpp>\n", {"client/client.cpp:1: lua.hpp"}},
      {"client/bots/bots.cpp",
       "#include <lua.hpp>\n#include \"server/server.h\"\n",
       {"client/bots/bots.cpp:2: server/"}},
      {"elsewhere/x.cpp", "", {"elsewhere/x.cpp:1: no layer"}},
  };
  for (const Case& each : cases) {
    const Strings found = FindOffences(each.path, each.text);
    ASSERT_EQ(found.size(), each.offences.size()) << each.path << "\n" << each.text << testing::PrintToString(found);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].rfind(each.offences[i], 0), 0U) << found[i];
  }
}

}  // namespace
}  // namespace wobble::test
