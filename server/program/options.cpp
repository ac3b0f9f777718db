#include "server/program/options.h"

#include <fmt/format.h>

#include <charconv>

#include "protocol/usage/command_line.h"
#include "protocol/usage/duration.h"
#include "protocol/version.h"

namespace wobble::server {
namespace {

constexpr Range kExportFpsRange{0.001, 480};        // and at most the recording's ticks a second
constexpr Range kRecordRange{1, 65536};             // MiB
constexpr Range kSeedRange{0, 9007199254740992.0};  // 2^53: exact as a number in JSON too

// A bad number is noted and not thrown, so that all of them are reported together, each with its range.
template <class Number>
CLI::Option* AddNumber(CLI::App& app, const char* name, Range range, Number& value, const char* description,
                       std::vector<std::string>& errors) {
  const auto read = [name, range, &value, &errors](const std::string& text) {
    Number number{};
    const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool isWhole = result == std::errc{} && end == text.data() + text.size();
    if (isWhole && static_cast<double>(number) >= range.low && static_cast<double>(number) <= range.high) {
      value = number;
    } else {
      errors.push_back(fmt::format("{} {}: must be {} to {}", name, text, range.low, range.high));
    }
  };
  return app.add_option_function<std::string>(name, read, description)
      ->type_name(fmt::format("{} to {}", range.low, range.high))
      ->default_str(fmt::format("{}", value));
}

}  // namespace

void DescribeOptions(CLI::App& app, Options& options) {
  Config& config = options.config;
  const auto addNumber = [&](const char* name, Range range, auto& value, const char* description) {
    return AddNumber(app, name, range, value, description, options.errors);
  };
  const auto addDuration = [&](const char* name, double& value, const char* description) {
    const auto refuse = [name, &options](const std::string& text) {
      options.errors.push_back(
          fmt::format("{} {}: must be 0 to {}, such as 90, 90s, 500ms, 1.5m or 2h", name, text, usage::kMaxDuration));
    };
    return usage::AddDuration(app, name, value, description, refuse);
  };
  app.description("wobbled hosts a world of soft bodies for many players.");
  app.set_version_flag("--version", std::string("wobbled ") + kVersion);
  CLI::Option* scene = app.add_option("--scene", options.scene, "Name of a shipped scene, or a path to a .toml file")
                           ->capture_default_str();
  CLI::Option* rotation =
      app.add_option("--rotation", options.rotation,
                     "Scenes that follow one another, such as arena,sumo,curtain: after a match (--rounds), by the "
                     "orders next and scene, by the players' vote, and with --reset-when-empty; all stay in")
          ->type_name("SCENES")
          ->delimiter(',')
          ->excludes(scene);
  app.add_option("--name", options.name, "What browsers of servers show, up to 63 bytes (the scene's name)")
      ->type_name("TEXT");
  app.add_flag("--hidden", options.isHidden,
               "Do not answer server queries (A2S): only who is in learns what is played");
  app.add_flag("--announce", options.isAnnounced,
               "Announce the world in the local network (DNS-SD), for wobble list and other browsers of services")
      ->excludes("--hidden");
  addNumber("--port", kPortRange, config.port, "UDP port; 0: a free one, printed at the start");
  app.add_option("--bind", options.bind,
                 "Address to listen at, such as 127.0.0.1 or ::1; every address of the machine, IPv6 and IPv4, if not "
                 "given")
      ->type_name("ADDRESS");
  app.add_option("--key", options.keyFile,
                 "File of the server's secret key, by which clients know it again; made if it is not there "
                 "(server.key in the user's state folder)")
      ->type_name("FILE");
  const auto addFile = [&](const char* name, std::string& file, const char* description) {
    app.add_option(name, file, description)->type_name("FILE");
  };
  addFile("--password-file", options.gate.password,
          "File whose first line is the password that players need, read at the start; who has a valid invite, token "
          "or the "
          "owner's key needs none");
  addFile("--invites", options.gate.invites,
          "File that keeps invites; then only who is invited may come in (wobble admin invite), or who has a valid "
          "password, token or the owner's key");
  addFile(
      "--token-key", options.gate.tokenKey,
      "File of the key that connect tokens are sealed with; then players need one (wobble token), or a valid password, "
      "invite or the owner's key");
  addFile("--gateway-key", options.gate.gatewayKey,
          "File of the key that gateways share, which then say their browsers' addresses");
  addFile("--owner-key", options.gate.ownerKey,
          "File of the key that makes whoever has it an owner; made if it is not there (owner.key in the user's state "
          "folder)");
  addFile("--bans", options.gate.bans, "File that keeps bans from one start to the next");
  app.add_option("--admin-socket", options.adminSocket, "Unix socket to take orders at (wobble admin)")
      ->type_name("PATH");
  app.add_option(
      "--admin-http", options.adminHttp,
      "HOST:PORT, or PORT for this machine only, that takes orders by HTTP from who has the owner's key; PORT "
      "0: a free one; printed at the start");
  app.add_option(
         "--rcon", options.rcon,
         "HOST:PORT, or PORT for this machine only, that takes orders by Source RCON from who knows the password "
         "of --rcon-password-file; PORT 0: a free one; printed at the start")
      ->type_name("HOST:PORT or PORT");
  app.add_option("--rcon-password-file", options.rconPasswordFile,
                 "File whose first line is the password of --rcon, read at the start")
      ->type_name("FILE");
  addNumber("--tick-hz", kTickHzRange, config.tickHz, "Steps of the world a second");
  addNumber("--snapshot-hz", kSnapshotHzRange, config.snapshotHz, "Snapshots a second, at most --tick-hz");
  addNumber("--max-clients", kMaxClientsRange, config.maxClients, "Players and spectators at once");
  addNumber("--max-per-address", kMaxPerAddressRange, config.maxPerAddress,
            "Connections from one IP address; 0: as many as --max-clients");
  addNumber("--threads", kThreadsRange, config.threads, "Threads that step and encode bodies");
  addNumber("--client-kbit", kClientKbitRange, config.clientKbit,
            "The most that snapshots of a client take, kbit/s with headers; within it, what the link has room for");
  addNumber("--view-distance", kViewDistanceRange, config.viewDistance,
            "Metres from a player's body within which other bodies are sent");
  addDuration("--pause-after", config.pauseAfter,
              "How long after the last has left the world pauses; 0: it never does");
  app.add_flag("--admit-when-busy", config.admitsWhenBusy,
               "Let clients in even when ticks take longer than there is time for");
  addNumber("--rounds", kRoundsRange, config.rounds,
            "Rounds of the scene's game that make a match; 0: as the scene says");
  const auto readAfterMatch = [&options](const std::string& word) {
    if (word != "end" && word != "restart" && word != "next") {
      options.errors.push_back("--after-match " + word + ": must be end, restart or next");
    }
    options.hasAfterMatch = true;
    options.config.afterMatch = word == "restart" ? AfterMatch::kRestart
                                : word == "next"  ? AfterMatch::kNext
                                                  : AfterMatch::kEnd;
  };
  app.add_option_function<std::string>(
         "--after-match", readAfterMatch,
         "end: the server ends with the match; restart: the world begins anew, and all stay in; next: so does the next "
         "scene of --rotation")
      ->type_name("end, restart or next")
      ->default_str("end; with --rotation next");
  app.add_flag("--reset-when-empty", config.resetsWhenEmpty,
               "The world begins anew when the last client has left, or the next scene of --rotation: what was torn is "
               "whole for who comes next");
  app.add_flag("--no-chat", config.forbidsChat, "Players say no lines to one another; emotes stay");
  addDuration("--for", options.runFor, "How long to run; 0: until Ctrl-C");
  addNumber("--seed", kSeedRange, config.seed, "Seed of the scene's random placement");
  app.add_option("--log-level", options.logLevel, "debug, info, warn, error or off")->capture_default_str();
  app.add_option("--log-format", options.logFormat,
                 "Of the log on stderr. text: lines with date and time; json: one object a line")
      ->type_name("text or json")
      ->capture_default_str();
  addDuration("--status", options.statusEvery, "Time between status lines on stdout; 0: none");
  app.add_option("--summary", options.summaryFile, "File to write a summary of the run to, as JSON");
  app.add_option("--ops", options.ops,
                 "HOST:PORT, or PORT for this machine only, that answers /metrics (Prometheus), /healthz and /readyz; "
                 "PORT 0: a free one, printed at the start");
  app.add_option("--trace", options.traceFile, "File to write the phases of every tick to, for chrome://tracing");
  app.add_option("--cache", options.cacheFolder,
                 "Folder that keeps trained bases of shapes from one start to the next");
  CLI::Option* record =
      app.add_option(
             "--record", options.recordFolder,
             "Folder to record all that is played in, as files that --replay plays again; made if it is not there")
          ->type_name("FOLDER");
  addNumber("--record-size", kRecordRange, options.recordMib, "MiB after which a recording goes on in another file")
      ->needs(record);
  app.add_option(
         "--state", options.stateFolder,
         "Folder that keeps the world, once a second: after a crash or a restart the server goes on from it, and "
         "players come back to their bodies; made if it is not there")
      ->type_name("FOLDER");
  CLI::Option* replay =
      app.add_option("--replay", options.replayFile,
                     "Recording to show to all who come in, who wind it with film orders (see --verify)")
          ->type_name("FILE");
  replay->excludes("--record")
      ->excludes("--state")
      ->excludes(scene)
      ->excludes(rotation)
      ->excludes("--tick-hz")
      ->excludes("--seed");
  app.add_flag("--verify", options.isVerify,
               "Play --replay as fast as it goes and say whether every tick is the same, or the first second, tick and "
               "body that are not (exit code 1)")
      ->needs(replay);
  CLI::Option* target = app.add_option("--export", options.exportTarget,
                                       "File (csv, gltf) or new folder (vtk) to write what --replay holds to, and end")
                            ->type_name("PATH")
                            ->needs(replay)
                            ->excludes("--verify");
  app.add_option(
         "--format", options.exportFormat,
         "Of --export. csv: a row a body and frame, with pose and energies. vtk: a .pvd series of PolyData with "
         "velocity, force and energy of each vertex, for ParaView. gltf: an animation as one .glb, for Blender and the "
         "web, y up. SI units; csv and vtk z up")
      ->check(CLI::IsMember({"csv", "vtk", "gltf"}))
      ->capture_default_str()
      ->needs(target);
  app.add_flag("--force", options.isForced, "Replace what is there at --export, unless it is a recording")
      ->needs(target);
  addDuration("--from", options.exportFrom, "Time of the recording at which the export begins")->needs(target);
  addDuration("--to", options.exportTo, "Time at which it ends; as --from: one frame")
      ->default_str("the recording's end")
      ->needs(target);
  addNumber("--fps", kExportFpsRange, options.exportFps,
            "Frames a second of the export, at most the recording's ticks a second")
      ->needs(target);
  const auto readBodies = [&options](const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      std::uint32_t& body = options.exportBodies.emplace_back();
      const auto [end, result] = std::from_chars(word.data(), word.data() + word.size(), body);
      if (result == std::errc{} && end == word.data() + word.size()) continue;
      options.errors.push_back("--bodies " + word + ": must be numbers of bodies, such as 3,7,12");
    }
  };
  app.add_option_function<std::vector<std::string>>("--bodies", readBodies,
                                                    "Numbers of the bodies to export, such as 3,7,12; all if not given")
      ->type_name("NUMBERS")
      ->delimiter(',')
      ->needs(target);
  app.add_flag("--untrained", options.isUntrained,
               "Start at once, without trained bases: shapes take three times the bits");
  app.add_flag("--check", options.isCheck, "Only name every mistake in the options, exit code 2, or none, 0");
  app.add_flag("--list-scenes", options.listScenes, "List the shipped scenes");
  app.add_option("--list-recordings", options.listFolder,
                 "List the recordings of a folder, the newest first: a line of JSON each")
      ->type_name("FOLDER");
  usage::RefuseEmptyWords(app);
  app.footer(
      "Examples:\n"
      "  wobbled                                  the arena on port 7777\n"
      "  wobbled --scene crowd --client-kbit 800  a busy scene for a host with little upstream\n"
      "  wobbled --scene my.toml --port 7801      a scene of your own\n"
      "  wobbled --password-file door.txt         for those who know it: wobble watch --password-file\n"
      "  wobbled --admin-socket admin.sock        then: wobble admin --socket admin.sock players\n"
      "  wobbled --scene curtain --reset-when-empty\n"
      "                                           whole again for the next visitors\n"
      "  wobbled --rotation arena,sumo,curtain --admin-socket admin.sock\n"
      "                                           then: wobble admin --socket admin.sock next\n"
      "  wobbled --announce --name \"Ada's world\"  then, in the same network: wobble list\n"
      "  wobbled --rcon 7777 --rcon-password-file rcon.txt\n"
      "                                           orders by any RCON client, on this machine\n"
      "  wobbled --for 30 --summary run.json      half a minute, figures at the end\n"
      "  wobbled --ops 9100                       then: curl 127.0.0.1:9100/metrics\n"
      "  wobbled --record matches                 record what is played; then, to prove it:\n"
      "  wobbled --replay matches/arena-20261124-180000.wobrec --verify\n"
      "  wobbled --replay matches/arena-20261124-180000.wobrec --export arena.csv --fps 10\n"
      "  wobbled --for 90 --pause-after 0         the same without players: the world never pauses\n"
      "  WOBBLE_PORT=7790 wobbled --scene sumo    every option is a variable, too; what is written here wins");
}

void Complain(const Options& options, const std::vector<std::string>& mistakes) {
  for (const std::string& mistake : mistakes) fmt::print(stderr, "wobbled: {}\n", options.nameVariables(mistake));
}

}  // namespace wobble::server
