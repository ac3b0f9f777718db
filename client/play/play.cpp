#include "client/play/play.h"

#include <cctype>
#include <cstdio>
#include <cstdlib>

#include "client/command/exit_codes.h"
#include "client/host/fleet.h"
#include "client/host/temporary_folder.h"

namespace wobble::play {
namespace {

// Places for people, in addition to those of the bots.
constexpr unsigned kGuests = 64;
// Bots that play against people in a scene with a game, and their script.
struct Opponents {
  const char* scene;
  unsigned count;
  const char* script;
};
constexpr Opponents kOpponents[] = {{"sumo", 2, "chase.lua"}, {"goals", 5, "goals.lua"}, {"crown", 3, "crown.lua"}};

// A scene file's name without folder and extension, with only characters that an address may hold.
std::string FindName(const std::string& scene) {
  std::string name = std::filesystem::path(scene).stem().string().substr(0, 32);
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
  }
  return name;
}

// A world but the first stands still until a player comes, so that its beginning can be seen and it costs nothing.
// folder: for states and trained bases, with which a world that was killed goes on at once.
host::WorldPlan MakeWorld(const PlayOptions& options, std::size_t number, const std::filesystem::path& folder) {
  const std::string& scene = options.scenes[number];
  host::WorldPlan world;
  world.name = FindName(scene);
  world.title = number == 0 ? "server" : "server of " + world.name;
  world.port = static_cast<std::uint16_t>(options.port == 0 ? 0 : options.port + number);
  world.bots.count = number == 0 ? options.bots : 0;
  for (const Opponents& each : kOpponents) {
    if (scene != each.scene) continue;
    if (number > 0) world.bots.count = each.count;
    if (number > 0 || scene != "sumo") world.bots.script = each.script;
  }
  world.options = {"--scene",     scene,  "--max-clients", std::to_string(kGuests + options.bots),
                   "--log-level", "warn", "--state",       (folder / world.name).string()};
  const char* cache = std::getenv("WOBBLE_CACHE");  // which the children have, too
  if (cache == nullptr || *cache == '\0') {
    world.options.insert(world.options.end(), {"--cache", (folder / "bases").string()});
  }
  if (number > 0) world.options.insert(world.options.end(), {"--pause-after", "0.02"});
  if (!options.recordings.empty()) world.options.insert(world.options.end(), {"--record", options.recordings});
  return world;
}

// nullopt also where there is no page, which the notice says.
std::optional<host::GatewayPlan> MakeGateway(const PlayOptions& options, std::string& notice) {
  if (!options.http) return {};
  std::error_code error;
  if (!std::filesystem::is_directory(options.page, error)) {
    notice = "no page for browsers: '" + std::filesystem::proximate(options.page).string() +
             "' is not there; sh docker/packages.sh web and the next build make it";
    return {};
  }
  host::GatewayPlan gateway;
  gateway.port = *options.http;
  gateway.options = {"--page", options.page.string(), "--max-connections", std::to_string(kGuests)};
  if (!options.recordings.empty()) {
    gateway.options.insert(gateway.options.end(), {"--recordings", options.recordings});
  }
  return gateway;
}

}  // namespace

int RunPlay(const PlayOptions& options, const std::function<bool()>& stopAsked) {
  const host::TemporaryFolder temporary;
  const std::filesystem::path folder = options.state.empty() ? temporary.Path() : std::filesystem::path(options.state);
  if (folder.empty()) {
    std::fprintf(stderr, "wobble play: no temporary folder can be made\n");
    return command::kExitFailed;
  }
  host::Plan plan;
  plan.command = "wobble play";
  plan.programFolder = options.programFolder;
  plan.duration = options.duration;
  for (std::size_t number = 0; number < options.scenes.size(); ++number) {
    plan.worlds.push_back(MakeWorld(options, number, folder));
  }
  plan.gateway = MakeGateway(options, plan.notice);
  return host::RunFleet(plan, stopAsked);
}

}  // namespace wobble::play
