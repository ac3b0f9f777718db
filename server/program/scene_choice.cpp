#include "server/program/scene_choice.h"

#include <spdlog/spdlog.h>

#include <set>
#include <utility>

#include "server/discovery/teller.h"
#include "server/ops/address.h"
#include "server/program/order_doors.h"
#include "server/training/basis_shelf.h"

namespace wobble::server {

std::vector<scenes::LoadResult> LoadScenes(Options& options) {
  if (options.rotation.size() == 1) {
    options.errors.push_back("--rotation " + options.rotation.front() + ": must be two scenes or more");
  }
  if (options.config.afterMatch == AfterMatch::kNext && options.rotation.empty()) {
    options.errors.emplace_back("--after-match next: --rotation must say which scenes follow");
  }
  if (!options.rotation.empty()) {
    options.scene = options.rotation.front();
    if (!options.hasAfterMatch) options.config.afterMatch = AfterMatch::kNext;
  }
  std::vector<std::string> names = options.rotation;
  if (names.empty()) names.push_back(options.scene);
  std::vector<scenes::LoadResult> loaded;
  std::set<std::string> known;
  for (const std::string& name : names) {
    const auto& [scene, source, errors] = loaded.emplace_back(scenes::LoadScene(name, scenes::FindShippedScenes()));
    options.errors.insert(options.errors.end(), errors.begin(), errors.end());
    if (errors.empty() && !known.insert(scene.name).second) {
      options.errors.push_back("--rotation " + name + ": a scene of this name is in it already");
    }
  }
  return loaded;
}

std::vector<RotationScene> TrainScenes(const Options& options, std::vector<scenes::LoadResult> loaded) {
  std::vector<RotationScene> trained;
  for (scenes::LoadResult& each : loaded) {
    if (loaded.size() > 1) {
      spdlog::info("scene {} of {}: {}", trained.size() + 1, loaded.size(), each.scene.name);
    }
    std::vector<Bases> bases;
    if (!options.isUntrained) bases = LoadBases(each.scene, options.cacheFolder, options.config.threads);
    trained.push_back({.scene = std::move(each.scene), .source = std::move(each.source), .bases = std::move(bases)});
  }
  return trained;
}

std::vector<std::string> FindMistakes(const Options& options, const std::vector<scenes::LoadResult>& loaded) {
  std::vector<std::string> mistakes = options.errors;
  if (const std::string fault = discovery::FindFault(options.name); !fault.empty()) {
    mistakes.push_back("--name " + options.name + ": " + fault);
  }
  if (options.isAnnounced && ops::IsThisMachine({.host = options.bind})) {
    mistakes.push_back("--announce: nobody else reaches --bind " + options.bind);
  }
  const auto add = [&mistakes](const std::vector<std::string>& more) {
    mistakes.insert(mistakes.end(), more.begin(), more.end());
  };
  // Of scenes that were not read nothing can be said.
  if (mistakes.empty()) {
    std::vector<scenes::Scene> all;
    for (const scenes::LoadResult& each : loaded) all.push_back(each.scene);
    add(Validate(options.config, all));
  }
  if (!options.isCheck) return mistakes;
  add(admission::FindMistakes(options.gate));
  std::string fault;
  const bool wantsRcon = !options.rcon.empty() || !options.rconPasswordFile.empty();
  if (wantsRcon && !ReadRconDoor(options, fault)) mistakes.push_back(fault);
  for (const auto& [option, text] : {std::pair("--ops ", options.ops), std::pair("--admin-http ", options.adminHttp)}) {
    ops::Address address;
    std::string error;
    if (!text.empty() && !ops::ParseAddress(text, address, error)) mistakes.push_back(option + error);
  }
  return mistakes;
}

}  // namespace wobble::server
