// The rooms of the house: which room may reach which, through any number of includes, and which packages it may name.
//
// A room is a folder or, where one file is allowed more than its folder, that file. The longest path that matches a
// file decides. Three things are checked:
//   own headers    every header that a file reaches, directly or through others, lies in a room that the table allows;
//                  the message names the file, the header that it must not reach, and the way between them;
//   packages       each <...> include that a file names itself is the standard library's or a package of its room, and
//                  no standard header that its room refuses (clocks, files and logs where time is a parameter);
//   physics meets protocol   in server/session and server/snapshots alone: no other file of server/ itself names a
//                  physics header together with a protocol header that has poses, vertices or messages in it. That
//                  rule is about names, not reach: server.cpp calls all five stages and so reaches everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/places.h"

namespace wobble::test {
namespace {

using Strings = std::vector<std::string>;

struct Room {
  std::string path;     // a folder with its '/', or one file without its ending
  Strings reaches;      // beginnings of the paths that its files may reach, beside the room itself
  Strings packages;     // beginnings of angle includes beside the standard library
  Strings notStandard;  // standard headers refused here
};

const Strings kClockFileLog{"chrono", "ctime", "iostream", "fstream", "filesystem", "cstdio", "thread"};
// Emscripten's library lacks the second line.
const Strings kPortable{"chrono", "ctime",  "iostream", "fstream",    "filesystem", "cstdio",
                        "thread", "ranges", "format",   "stop_token", "concepts",   "source_location"};
const Strings kClock{"chrono", "ctime"};
const Strings kSystem{"arpa/",   "fcntl.h",  "netdb.h", "netinet/", "poll.h",    "pthread.h",
                      "sched.h", "signal.h", "spawn.h", "sys/",     "termios.h", "unistd.h"};
const Strings kEngine{"Eigen/", "immintrin.h", "arm_neon.h"};

Strings Join(Strings first, const Strings& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

const std::string kLanes = "server/physics/lanes/", kKernels = "server/physics/kernels/",
                  kContactKernels = "server/physics/kernels/contact/", kModel = "server/physics/model/",
                  kContact = "server/physics/contact/", kSkins = "server/physics/skins/",
                  kEdges = "server/physics/edges/", kMethods = "server/physics/methods/",
                  kMeshing = "server/physics/meshing/", kShapes = "server/physics/shapes/",
                  kStep = "server/physics/step/", kPacks = "server/physics/packs/", kPhysics = "server/physics/",
                  kScenes = "server/scenes/", kTiming = "server/timing/", kPlay = "server/play/",
                  kRecording = "server/recording/", kSnapshots = "server/snapshots/", kProtocol = "protocol/",
                  kCodec = "protocol/codec/", kEncoding = "protocol/codec/encoding/",
                  kVestibule = "protocol/transport/vestibule/", kUsage = "protocol/usage/", kClient = "client/";
// The headers of the client library itself, without the rooms of the commands.
const Strings kCommandReach{kClient, kProtocol};

// CONTRIBUTING.md's table. Rooms that are named first are more particular.
const std::vector<Room> kRooms{
    {kLanes, {}, kEngine, kClockFileLog},
    {kContactKernels, {kLanes}, kEngine, kClockFileLog},
    {kKernels, {kContactKernels, kLanes}, kEngine, kClockFileLog},
    {kModel, {kKernels, kLanes}, Join(kEngine, {"oneapi/tbb", "tbb/"}), kClockFileLog},
    {kContact, {kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kSkins, {kContact, kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kEdges, {kSkins, kContact, kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kMethods, {kContact, kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kMeshing, {kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kShapes, {kMeshing, kMethods, kContact, kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kStep, {kMethods, kEdges, kSkins, kContact, kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kPacks, {kStep, kMethods, kEdges, kSkins, kContact, kModel, kKernels, kLanes}, kEngine, kClockFileLog},
    {kPhysics, {}, Join(kEngine, {"tbb/"}), kClockFileLog},
    {kScenes, {kPhysics}, {"toml++/"}, kClock},
    {kTiming, {}, {}, kClock},
    {kPlay, {kPhysics, kScenes, kTiming}, {"spdlog/fmt/"}, kClock},
    // It alone writes worlds to files. Its writing thread is told the time.
    {kRecording + "recorder",
     {kRecording, kPhysics, kScenes, kPlay, kTiming},
     {"fmt/", "fcntl.h", "unistd.h"},
     {"iostream", "fstream"}},
    // What recordings hold, for other programs.
    {"server/export/",
     {kRecording, kPhysics, kScenes, kPlay, kTiming},
     {"Eigen/", "fmt/", "nlohmann/"},
     {"chrono", "ctime", "iostream", "thread"}},
    {kRecording,
     {kPhysics, kScenes, kPlay, kTiming},
     {"Eigen/", "fcntl.h", "fmt/", "sys/file.h", "unistd.h", "zlib.h", "zstd.h"},
     kClock},
    // Bodies leave the engine in Eigen's types, and a body's rotation is found with Eigen's solvers.
    {kSnapshots, {kPhysics, kScenes, kPlay, kTiming, kProtocol}, {"Eigen/", "oneapi/tbb", "tbb/"}, kClock},
    // Bases are eigenvectors of what play does to a body.
    {"server/training/",
     {kSnapshots, kPhysics, kScenes, kPlay, kTiming, kProtocol},
     {"Eigen/", "fmt/", "spdlog/"},
     kClock},
    {"server/ops/agones_messages", {"server/ops/fleet_"}, {"nlohmann/"}, kClockFileLog},
    // It alone waits, on a thread of its own; what is called and when is decided in fleet_*.
    {"server/ops/agones", {"server/ops/"}, {"httplib.h", "signal.h", "spdlog/"}, {}},
    {"server/ops/fleet_duty", {}, {}, kClockFileLog},
    {"server/ops/fleet_reconciler", {"server/ops/fleet_duty"}, {}, kClockFileLog},
    // What listens by TCP.
    {"server/ops/address", {}, {}, kClockFileLog},
    {"server/ops/acceptor", {"server/ops/address"}, {"boost/", "fmt/"}, {}},
    {"server/ops/http_listener", {"server/ops/acceptor", "server/ops/address"}, {"boost/", "fmt/"}, {}},
    {"server/ops/", {"server/", kProtocol}, Join(kSystem, {"fmt/", "nlohmann/", "prometheus/", "spdlog/"}), kClock},
    {"server/main", {"server/", kProtocol}, Join(kSystem, {"CLI/", "fmt/", "nlohmann/", "spdlog/"}), {}},
    // For Python: the interfaces for C, what is behind that of the physics, and the laboratory's problems.
    {"server/library/python/client", {"server/library/python/", "client/wobble"}, {"pybind11/"}, {}},
    {"server/library/python/client_rules", {"server/library/python/", "client/wobble"}, {"pybind11/"}, {}},
    {"server/library/python/client_surroundings", {"server/library/python/", "client/wobble"}, {"pybind11/"}, kClock},
    {"server/library/python/",
     {"server/library/", kRecording, kPlay, kScenes, kPhysics, kTiming, "protocol/c/", "protocol/version",
      "tests/bench/accuracy/", "tests/bench/thread_time"},
     {"pybind11/"},
     kClock},
    // The physics for C.
    {"server/library/",
     {kRecording, kPlay, kScenes, kPhysics, kTiming, "protocol/c/", "protocol/version"},
     {"dlfcn.h", "stddef.h", "stdint.h"},
     kClock},
    // The parts of main.
    {"server/program/options",
     {"server/config.h", "server/admission/", kScenes, kPhysics, kPlay, kTiming, kSnapshots, kProtocol},
     {"CLI/", "fmt/"},
     kClock},
    {"server/program/", {"server/", kProtocol}, Join(kSystem, {"CLI/", "fmt/", "nlohmann/", "spdlog/"}), {}},
    // Who may come in; the time is a parameter.
    {"server/admission/record_file", {}, {"fcntl.h", "unistd.h"}, kClock},
    {"server/admission/refusal_log", {kProtocol}, {"fmt/", "spdlog/"}, kClock},
    {"server/admission/", {kProtocol}, {}, {"chrono", "ctime", "iostream", "fstream", "thread"}},
    // Its socket has a thread, and so a clock, of its own.
    {"server/admin/admin_socket", {"server/", kProtocol}, kSystem, {}},
    {"server/admin/admin_http", {"server/", kProtocol}, {}, {}},
    {"server/admin/order_queue", {"server/", kProtocol}, {}, {}},
    {"server/admin/rcon_listener", {"server/", kProtocol}, {"boost/", "fmt/", "spdlog/"}, {}},
    {"server/admin/", {"server/", kProtocol}, {"fmt/", "spdlog/"}, {"ctime", "iostream", "fstream", "thread"}},
    // It has a thread, and so a clock, of its own.
    {"server/discovery/announcement", {"server/discovery/", kProtocol}, {"avahi-", "spdlog/"}, {}},
    {"server/discovery/", {"server/", kProtocol}, {"fmt/"}, kClockFileLog},
    // Unicode's tables are the server's alone.
    {"server/names", {kProtocol}, {"unicode/"}, kClockFileLog},
    {"server/",
     {kTiming, kPlay, kRecording, "server/export/", kSnapshots, "server/training/", kScenes, kPhysics, kProtocol},
     {"fmt/", "nlohmann/", "oneapi/tbb", "prometheus/", "spdlog/", "tbb/"},
     kClock},
    // It alone has a thread, and so a clock, of its own; the door that it asks is told the time.
    {"protocol/transport/vestibule/doorkeeper",
     {kVestibule, kProtocol},
     kSystem,
     {"ctime", "iostream", "fstream", "filesystem", "cstdio"}},
    {"protocol/transport/vestibule/secret_file", {kVestibule, kProtocol}, {}, kClock},
    {"protocol/transport/vestibule/key_file", {kVestibule, kProtocol}, {"fcntl.h", "unistd.h"}, kClock},
    // It alone knows the cryptographic library.
    {kVestibule, {kProtocol}, Join(kSystem, {"sodium.h"}), kClockFileLog},
    {"protocol/transport/", {kProtocol}, Join(kSystem, {"enet/"}), kClockFileLog},
    // What the uses of all programs share.
    {kUsage, {}, {"CLI/", "fcntl.h", "unistd.h"}, kClock},
    {kEncoding, {kCodec, kProtocol}, {"flatbuffers/", "immintrin.h", "arm_neon.h"}, kPortable},
    {kCodec, {kProtocol}, {"flatbuffers/", "immintrin.h", "arm_neon.h"}, kPortable},
    {kProtocol, {}, {"flatbuffers/"}, kPortable},
    {"client/bots/", kCommandReach, Join(kSystem, {"CLI/", "lua.hpp", "nlohmann/"}), {}},
    {"client/command/", kCommandReach, Join(kSystem, {"CLI/", "ifaddrs.h", "net/if.h", "nlohmann/", "qrencode.h"}), {}},
    {"client/terminal/", kCommandReach, Join(kSystem, {"CLI/"}), {}},
    {"client/gateway/", kCommandReach, Join(kSystem, {"CLI/", "boost/", "openssl/", "zlib.h"}), {}},
    {"client/wasm/", kCommandReach, {"emscripten"}, {}},
    {"client/health/", kCommandReach, {"CLI/", "httplib.h"}, {}},
    {"client/admin/", kCommandReach, Join(kSystem, {"CLI/", "httplib.h"}), {}},
    {"client/export/", kCommandReach, {"CLI/", "unistd.h"}, {}},
    {"client/token/", kCommandReach, {"CLI/"}, {}},
    {"client/link/", kCommandReach, Join(kSystem, {"CLI/"}), {}},
    {"client/list/", kCommandReach, {"CLI/", "avahi-", "httplib.h", "nlohmann/"}, {}},
    {"client/play/", kCommandReach, Join(kSystem, {"CLI/"}), {}},
    // It decides when; the time is a parameter.
    {"client/host/keeper", {}, {}, kClockFileLog},
    {"client/host/", kCommandReach, Join(kSystem, {"CLI/", "nlohmann/", "toml++/"}), {}},
    {"client/main", kCommandReach, Join(kSystem, {"CLI/", "nlohmann/"}), {}},
    // The client for C; programs include its header alone.
    {"client/wobble", {}, {"stdint.h"}, {}},
    {"client/c/", kCommandReach, {}, kClockFileLog},
    // A developer copies it: the packages of the library and the standard library are all that it needs.
    {"client/example", kCommandReach, {}, {}},
    {"client/files/", {kClient, kProtocol}, {"unistd.h"}, kClock},
    {"client/timing/", {kProtocol}, {}, kPortable},
    {kClient, {kProtocol}, {}, kPortable},
};
// Paths that a room may not reach although its line of the table covers them: rooms below its own folder, and sockets
// where the Transport interface is all that is needed.
const Strings kSockets{kVestibule, "protocol/transport/enet", "protocol/transport/link", "protocol/transport/relay",
                       "protocol/transport/virtual"};
const std::map<std::string, Strings> kRefused{
    {kProtocol, {"protocol/transport/", kCodec, kUsage}},
    {kEncoding, {"protocol/transport/"}},
    {kCodec, {"protocol/transport/", kEncoding}},
    {kClient, Join(kSockets, {kUsage, "client/admin/", "client/bots/", "client/c/", "client/command/", "client/files/",
                              "client/gateway/", "client/health/", "client/host/", "client/link/", "client/list/",
                              "client/play/", "client/terminal/", "client/token/", "client/wasm/"})},
    {"server/", Join(kSockets, {kUsage, "server/admin/", "server/admission/", "server/discovery/", "server/ops/",
                                "server/program/"})},
    {"server/program/options", {"server/ops/"}},
};

const Strings kMeetingPlaces{"server/session.", kSnapshots,        "server/training/",
                             "server/main.",    "server/program/", "server/ops/"};
const Strings kTypedProtocolHeaders{"protocol/geometry.h", "protocol/messages", "protocol/codec/pose.h",
                                    "protocol/codec/shape_codec.h", kEncoding};

bool BeginsWith(const std::string& text, const std::string& prefix) { return text.rfind(prefix, 0) == 0; }
bool BeginsWithOneOf(const std::string& text, const Strings& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string& prefix) { return BeginsWith(text, prefix); });
}

const Room* FindRoom(const std::string& path) {
  const auto matches = [&](const Room& room) {
    if (room.path.back() == '/') return BeginsWith(path, room.path);
    return path == room.path + ".h" || path == room.path + ".cpp";
  };
  const auto room = std::find_if(kRooms.begin(), kRooms.end(), matches);
  return room == kRooms.end() ? nullptr : &*room;
}

bool MayReach(const Room& room, const std::string& header) {
  const auto refused = kRefused.find(room.path);
  if (refused != kRefused.end() && BeginsWithOneOf(header, refused->second)) return false;
  return BeginsWith(header, room.path) || BeginsWithOneOf(header, room.reaches);
}

// Headers of C++ alone have neither folder nor ending.
bool IsStandardHeader(const std::string& name) { return name.find_first_of("/.") == std::string::npos; }

std::string Trim(const std::string& text) {
  const auto isSpace = [](unsigned char c) { return std::isspace(c) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), isSpace);
  return {begin, std::find_if_not(text.rbegin(), std::make_reverse_iterator(begin), isSpace).base()};
}

struct Include {
  int line = 0;
  char opening = '"';  // or '<', or '?' where the directive names no file
  std::string name;
};

std::vector<Include> ListIncludes(const std::string& text) {
  std::vector<Include> includes;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string directive = Trim(line);
    if (directive.empty() || directive[0] != '#') continue;
    const std::string rest = Trim(directive.substr(1));
    if (!BeginsWith(rest, "include")) continue;
    const std::string target = Trim(rest.substr(std::string("include").size()));
    const std::size_t closing = target.empty() ? std::string::npos : target.find(target[0] == '<' ? '>' : '"', 1);
    if (closing == std::string::npos || (target[0] != '<' && target[0] != '"')) {
      includes.push_back({number, '?', target});
    } else {
      includes.push_back({number, target[0], target.substr(1, closing - 1)});
    }
  }
  return includes;
}

using Sources = std::map<std::string, std::string>;  // path from the root to text

// The headers that a file reaches, each with the file that includes it on a shortest way; the file itself included.
std::map<std::string, std::string> FindReached(const std::string& path, const Sources& sources) {
  std::map<std::string, std::string> from{{path, ""}};
  Strings open{path};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto source = sources.find(open[i]);
    if (source == sources.end()) continue;
    for (const Include& include : ListIncludes(source->second)) {
      if (include.opening == '"' && from.emplace(include.name, open[i]).second) open.push_back(include.name);
    }
  }
  return from;
}

std::string DescribeWay(const std::map<std::string, std::string>& from, const std::string& header) {
  std::string way = header;
  for (std::string at = from.at(header); !at.empty(); at = from.at(at)) way = at + " > " + way;
  return way;
}

// One line "file:line: ..." for each offence in what the file itself says.
void FindOwnOffences(const std::string& path, const Room& room, const std::string& text, Strings& offences) {
  bool hasPhysics = false, hasTyped = false;
  for (const Include& include : ListIncludes(text)) {
    const auto report = [&](const std::string& what) {
      offences.push_back(path + ":" + std::to_string(include.line) + ": " + include.name + " " + what);
    };
    if (include.opening == '?') {
      report("cannot be checked");
    } else if (include.opening == '<') {
      const bool standard = IsStandardHeader(include.name);
      const auto& refused = room.notStandard;
      if (standard && std::find(refused.begin(), refused.end(), include.name) != refused.end())
        report("has no place in " + room.path);
      if (!standard && !BeginsWithOneOf(include.name, room.packages)) report("is not a package of " + room.path);
    } else if (include.name.find('/') == std::string::npos) {
      report("is not written from the root");
    }
    const bool isPhysics = BeginsWith(include.name, kPhysics) && include.name != "server/physics/model/parallel.h";
    const bool isTyped = BeginsWithOneOf(include.name, kTypedProtocolHeaders);
    hasPhysics |= isPhysics;
    hasTyped |= isTyped;
    const bool mayMeet = !BeginsWith(path, "server/") || BeginsWithOneOf(path, kMeetingPlaces);
    if (!mayMeet && hasPhysics && hasTyped && (isPhysics || isTyped))
      report("makes physics meet protocol outside session and snapshots");
  }
}

Strings FindOffences(const std::string& path, const Sources& sources) {
  const Room* room = FindRoom(path);
  if (room == nullptr) return {path + ":1: no room is known for this file"};
  Strings offences;
  FindOwnOffences(path, *room, sources.at(path), offences);
  const auto reached = FindReached(path, sources);
  for (const auto& [header, from] : reached) {
    if (header == path || header.find('/') == std::string::npos || MayReach(*room, header)) continue;
    // What a header of the same room reaches is told of that header.
    const Room* fromRoom = FindRoom(from);
    if (from != path && fromRoom == room && from.size() > 2 && from.substr(from.size() - 2) == ".h") continue;
    if (from != path && fromRoom != nullptr && fromRoom != room && !MayReach(*room, from)) continue;
    offences.push_back(path + ": may not reach " + header + " (" + DescribeWay(reached, header) + ")");
  }
  return offences;
}

bool IsSource(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".h" || extension == ".cpp" || extension == ".inl";
}

Sources ReadSources() {
  Sources sources;
  const std::filesystem::path root = std::filesystem::path(FindSource("server")).parent_path();
  for (const char* folder : {"server", "protocol", "client"}) {
    for (auto entry = std::filesystem::recursive_directory_iterator(root / folder);
         entry != std::filesystem::recursive_directory_iterator(); ++entry) {
      // client/engines is compiled by others, with an engine's headers and wobble.h alone: install.engines.
      const auto name = entry->path().filename();
      if (name == "node_modules" || name == "engines") entry.disable_recursion_pending();
      if (!entry->is_regular_file() || !IsSource(entry->path())) continue;
      std::ifstream file(entry->path());
      std::ostringstream text;
      text << file.rdbuf();
      sources.emplace(entry->path().lexically_relative(root).generic_string(), text.str());
    }
  }
  return sources;
}

TEST(Layering, EveryFileKeepsToTheRoomsThatItMayReach) {
  const Sources sources = ReadSources();
  ASSERT_GT(sources.size(), 200U) << "is " << FindSource("") << " the source?";
  for (const auto& [path, text] : sources) {
    for (const std::string& offence : FindOffences(path, sources)) ADD_FAILURE() << offence;
  }
}

// The measure of "a reader finds each thing where its name says": more units than this in one folder is a room that
// wants to be two.
TEST(Layering, NoRoomHasTooManyUnits) {
  constexpr int kMostUnits = 18;
  std::map<std::string, int> units;
  for (const auto& [path, text] : ReadSources()) {
    if (path.substr(path.size() - 4) == ".cpp") ++units[path.substr(0, path.rfind('/'))];
  }
  for (const auto& [folder, count] : units) EXPECT_LE(count, kMostUnits) << folder;
}

struct Case {
  std::string path;
  Sources sources;
  Strings offences;  // a part of each
};

// The checker itself: each law broken once is reported with both files, and what is allowed is not.
TEST(Layering, TheCheckerSeesEachOffence) {
  const std::string world = "server/physics/world.cpp";
  const auto alone = [](const std::string& path, const std::string& text, Strings offences) {
    return Case{path, {{path, text}}, std::move(offences)};
  };
  const std::vector<Case> cases{
      alone(world, "#include \"server/physics/world.h\"\n#include <Eigen/Core>\n#include <vector>\n", {}),
      alone(world, "// a\n#include \"protocol/limits.h\"\n", {"may not reach protocol/limits.h"}),
      alone(world, "#include \"server/session.h\"\n", {"may not reach server/session.h"}),
      alone(world, "#include <spdlog/spdlog.h>\n#include <chrono>\n",
            {"world.cpp:1: spdlog/spdlog.h", "world.cpp:2: chrono"}),
      alone(world, "#include \"world.h\"\n", {"world.cpp:1: world.h is not written"}),
      alone(world, "  #  include <server/physics/world.h>\n", {"world.cpp:1: server/"}),
      alone(world, "#include WORLD\n", {"world.cpp:1: WORLD cannot"}),
      alone(world, "// #include \"protocol/limits.h\"\n", {}),
      // The arrow runs up three headers away, and both ends are named.
      {"server/physics/kernels/sweep.cpp",
       {{"server/physics/kernels/sweep.cpp", "#include \"server/physics/kernels/sweep.h\"\n"},
        {"server/physics/kernels/sweep.h", "#include \"server/physics/kernels/terms.h\"\n"},
        {"server/physics/kernels/terms.h", "#include \"server/physics/model/blueprint.h\"\n"}},
       {}},
      {"server/physics/kernels/terms.h",
       {{"server/physics/kernels/terms.h", "#include \"server/physics/model/blueprint.h\"\n"}},
       {"kernels/terms.h: may not reach server/physics/model/blueprint.h"}},
      {"server/physics/contact/contact.h",
       {{"server/physics/contact/contact.h", "#include \"server/physics/model/state.h\"\n"},
        {"server/physics/model/state.h", "#include \"server/physics/step/body.h\"\n"}},
       {"contact/contact.h: may not reach server/physics/step/body.h (server/physics/contact/contact.h > "
        "server/physics/model/state.h > server/physics/step/body.h)"}},
      {"server/play/hands.cpp",
       {{"server/play/hands.cpp", "#include \"server/scenes/scene.h\"\n"},
        {"server/scenes/scene.h", "#include \"protocol/limits.h\"\n"}},
       {"play/hands.cpp: may not reach protocol/limits.h"}},
      {"client/client.cpp",
       {{"client/client.cpp", "#include \"protocol/codec/pose.h\"\n"},
        {"protocol/codec/pose.h", "#include \"server/physics/world.h\"\n"}},
       {"client/client.cpp: may not reach server/physics/world.h"}},
      alone("server/timing/tick_clock.h", "#include \"server/config.h\"\n", {"may not reach server/config.h"}),
      alone("server/scenes/loader.cpp", "#include \"server/physics/world.h\"\n#include <toml++/toml.h>\n", {}),
      alone("server/scenes/loader.cpp", "#include \"server/server.h\"\n", {"may not reach server/server.h"}),
      alone("server/server.cpp", "#include <enet/enet.h>\n", {"server.cpp:1: enet/enet.h"}),
      alone("server/server.cpp", "#include \"client/client.h\"\n", {"may not reach client/client.h"}),
      alone("server/server.cpp", "#include \"server/ops/metrics.h\"\n", {"may not reach server/ops/metrics.h"}),
      alone("server/main.cpp", "#include \"server/ops/metrics.h\"\n", {}),
      alone("server/server.cpp", "#include <httplib.h>\n", {"server.cpp:1: httplib.h"}),
      alone("server/ops/agones.cpp", "#include <httplib.h>\n#include <chrono>\n#include <thread>\n", {}),
      alone("server/ops/fleet_duty.cpp", "#include <chrono>\n", {"fleet_duty.cpp:1: chrono"}),
      alone("server/server.cpp", "#include \"server/physics/world.h\"\n#include \"protocol/snapshot.h\"\n", {}),
      alone("server/server.cpp", "#include \"server/physics/world.h\"\n#include \"protocol/codec/pose.h\"\n",
            {"server.cpp:2: protocol/codec/pose.h makes physics meet"}),
      alone("server/snapshots/capture.cpp", "#include \"server/physics/world.h\"\n#include \"protocol/codec/pose.h\"\n",
            {}),
      alone("protocol/codec/pose.cpp", "#include <Eigen/Core>\n#include <ranges>\n",
            {"pose.cpp:1: Eigen", "pose.cpp:2: ranges"}),
      alone("protocol/snapshot.cpp", "#include <enet/enet.h>\n", {"snapshot.cpp:1: enet"}),
      alone("protocol/transport/enet_transport.cpp", "#include <enet/enet.h>\n#include \"protocol/limits.h\"\n", {}),
      alone("client/client.cpp", "#include \"client/command/command.h\"\n", {"may not reach client/command/"}),
      alone("client/client.cpp", "#include <lua.hpp>\n", {"client.cpp:1: lua.hpp"}),
      alone("client/bots/bots.cpp", "#include <lua.hpp>\n#include \"server/server.h\"\n",
            {"may not reach server/server.h"}),
      alone("elsewhere/x.cpp", "", {"elsewhere/x.cpp:1: no room"}),
  };
  for (const Case& each : cases) {
    const Strings found = FindOffences(each.path, each.sources);
    ASSERT_EQ(found.size(), each.offences.size()) << each.path << ": " << testing::PrintToString(found);
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_NE(found[i].find(each.offences[i]), std::string::npos) << found[i];
  }
}

}  // namespace
}  // namespace wobble::test
