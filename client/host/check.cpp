// Some programs name one mistake at a time. So what was refused is left out and the program is asked again, until it
// is content, or names something that cannot be left out.
#include "client/host/check.h"

#include <poll.h>

#include <algorithm>
#include <cctype>

#include "client/command/child.h"
#include "client/host/keys.h"
#include "client/host/make_plan.h"

namespace wobble::host {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

// Runs a program to its end; the lines of its standard error, none when it ends with exit code 0.
Words Ask(const Words& command) {
  command::Child child;
  std::string error;
  if (!child.Start(command, error)) return {error};
  while (child.IsRunning()) {
    pollfd descriptor{child.ErrorsDescriptor(), POLLIN, 0};
    poll(&descriptor, 1, 5);  // a closed stream is no descriptor, and the wait is then for the process
    child.Update();
  }
  Words lines = child.TakeErrors();
  if (child.ExitCode() == 0) return {};
  if (lines.empty()) lines.push_back(command.front() + " ended with exit code " + std::to_string(*child.ExitCode()));
  return lines;
}

// Files and folders that a fleet's first start makes: they need not be there yet.
Words ListMade(const WorldsFile& file, const fs::path& folder) {
  Words made;
  for (const World& world : file.worlds) {
    made.push_back((MakeWorldPlan(file, world, folder).state / "bans").string());
    for (const char* key : {"record", "gateway_key"}) {
      if (const auto value = world.values.find(key); value != world.values.end())
        made.push_back(value->second.words[0]);
    }
  }
  made.push_back((folder / "gateway.key").string());
  return made;
}

// Adds the options of a plan, but those of what is to be made.
void AddThoseToCheck(const Words& options, const Words& made, Words& command) {
  for (const std::string& option : options) {
    const std::string value = option.substr(option.find('=') + 1);
    std::error_code ignored;
    const bool isMade = std::ranges::find(made, value) != made.end() && !fs::exists(value, ignored);
    if (!isMade) command.push_back(option);
  }
}

// Where an option stands in a line as a whole word; npos: it does not.
std::size_t FindOption(const std::string& line, const std::string& option) {
  for (std::size_t at = 0; (at = line.find(option, at)) != std::string::npos; at += option.size()) {
    const std::size_t end = at + option.size();
    if (end == line.size() || (std::isalnum(static_cast<unsigned char>(line[end])) == 0 && line[end] != '-')) return at;
  }
  return std::string::npos;
}

void AddOnce(Words& errors, const std::string& error) {
  if (std::ranges::find(errors, error) == errors.end()) errors.push_back(error);
}

// ask: of these values, what the program says.
template <class AskWith>
void CheckOne(Values values, const std::string& prefix, const std::string& otherwise, const AskWith& ask,
              Words& errors) {
  bool isStuck = false;
  while (!isStuck) {
    const Words lines = ask(values);
    if (lines.empty()) return;
    std::vector<std::string> refused;
    for (std::string line : lines) {
      if (line.starts_with(prefix)) line.erase(0, prefix.size());
      AddOnce(errors, Translate(line, values, otherwise, refused.emplace_back()));
      isStuck |= refused.back().empty();
    }
    for (const std::string& key : refused) values.erase(key);
  }
}

// What a scene's file has wrong names no option: it belongs to the line that names the scene.
std::string FindSceneLine(const World& world) {
  for (const char* key : {"scene", "rotation"}) {
    if (const auto value = world.values.find(key); value != world.values.end()) return value->second.where;
  }
  return world.where;
}

}  // namespace

std::string Translate(const std::string& line, const Values& values, const std::string& otherwise,
                      std::string& refused) {
  std::size_t first = std::string::npos;
  const Value* value = nullptr;
  for (const auto& [name, each] : values) {
    const std::size_t at = FindOption(line, OptionOf(name));
    if (at >= first || each.where.empty()) continue;
    first = at;
    refused = name;
    value = &each;
  }
  std::string said = line.substr(0, line.rfind(" (see "));
  if (value == nullptr) return otherwise + ": " + said;
  const std::size_t colon = first == 0 ? said.find(": ") : std::string::npos;
  if (colon != std::string::npos) said.erase(0, colon + 2);
  const std::string key = value->where.starts_with("WOBBLE_") ? value->where : value->where + ": " + refused;
  return key + " = " + value->shown + ": " + said;
}

Words CheckWithPrograms(const WorldsFile& file, const fs::path& folder, const fs::path& programFolder) {
  Words errors;
  const Words made = ListMade(file, folder);
  for (const World& world : file.worlds) {
    const auto ask = [&](const Values& values) {
      World changed = world;
      changed.values = values;
      const WorldPlan plan = MakeWorldPlan(file, changed, folder);
      Words command{(programFolder / "wobbled").string(), "--check"};
      AddThoseToCheck(plan.options, made, command);
      return Ask(command);
    };
    CheckOne(world.values, "wobbled: ", FindSceneLine(world) + ": world " + world.name, ask, errors);
  }
  if (!file.hasGateway) return errors;
  const auto ask = [&](const Values& values) {
    WorldsFile changed = file;
    changed.gateway = values;
    const GatewayPlan plan = MakeGatewayPlan(changed, folder);
    Words command{(programFolder / "wobble").string(),
                  "gateway",
                  "--check",
                  "--server",
                  "127.0.0.1:1",
                  "--bind",
                  plan.bindAddress};
    AddThoseToCheck(plan.options, made, command);
    return Ask(command);
  };
  CheckOne(file.gateway, "wobble gateway: ", "[gateway]", ask, errors);
  return errors;
}

}  // namespace wobble::host
