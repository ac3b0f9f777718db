#include "client/host/make_plan.h"

#include <cstdlib>

#include "client/host/keys.h"

namespace wobble::host {
namespace {

namespace fs = std::filesystem;

std::string Join(const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : ",") + word;
  return joined;
}

// Adds the options of a program that stand behind its keys. `=` so that a value may begin with a dash.
void AddOptions(const Values& values, Place place, std::vector<std::string>& options) {
  for (const auto& [name, value] : values) {
    const Key* key = FindKey(place, name);
    if (key == nullptr || !key->isOption) continue;
    if (key->kind == Kind::kNames) {
      options.push_back(OptionOf(name) + "=" + Join(value.words));
      continue;
    }
    for (const std::string& word : value.words) options.push_back(OptionOf(name) + "=" + word);
  }
}

}  // namespace

fs::path FindStateFolder(const WorldsFile& file, const fs::path& otherwise) {
  return FindWord(file.all, "state", otherwise.string());
}

WorldPlan MakeWorldPlan(const WorldsFile& file, const World& world, const fs::path& folder) {
  WorldPlan plan;
  plan.name = world.name;
  plan.title = "world " + world.name;
  plan.port = world.port;
  const std::string bind = FindWord(world.values, "bind", "");
  const bool isEverywhere = bind.empty() || bind == "0.0.0.0" || bind == "::";
  if (!isEverywhere) plan.host = bind.find(':') == std::string::npos ? bind : "[" + bind + "]";
  plan.label = plan.title + ", ";
  plan.bots.count = static_cast<unsigned>(std::strtoul(FindWord(world.values, "bots", "0").c_str(), nullptr, 10));
  plan.bots.script = FindWord(world.values, "script", plan.bots.script);
  const std::string password = FindWord(world.values, "password_file", "");
  if (!password.empty()) plan.bots.access.push_back("--password-file=" + password);
  plan.state = FindWord(world.own, "state", (folder / world.name).string());
  Values values = world.values;
  const auto setDefault = [&](const char* key, const std::string& word) { values.emplace(key, Value{{word}, "", ""}); };
  if (!values.contains("rotation")) setDefault("scene", world.name);
  setDefault("bans", (plan.state / "bans").string());
  setDefault("cache", (folder / "bases").string());
  if (file.hasGateway)
    setDefault("gateway_key", FindWord(file.gateway, "gateway_key", (folder / "gateway.key").string()));
  AddOptions(values, Place::kWorld, plan.options);
  plan.options.push_back("--state=" + plan.state.string());
  plan.options.push_back("--name=" + world.name);
  return plan;
}

GatewayPlan MakeGatewayPlan(const WorldsFile& file, const fs::path& folder) {
  GatewayPlan plan;
  Values values = file.gateway;
  plan.port = static_cast<std::uint16_t>(
      std::strtoul(FindWord(values, "http", std::to_string(plan.port)).c_str(), nullptr, 10));
  plan.bindAddress = FindWord(values, "bind", plan.bindAddress);
  values.erase("bind");
  const std::string key = FindWord(file.all, "gateway_key", (folder / "gateway.key").string());
  values.emplace("gateway_key", Value{{key}, "", ""});
  AddOptions(values, Place::kGateway, plan.options);
  return plan;
}

}  // namespace wobble::host
