#include "server/admission/open_gate.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "protocol/transport/vestibule/key_file.h"
#include "protocol/transport/vestibule/secret_file.h"

namespace wobble::admission {

namespace vestibule = transport::vestibule;

namespace {

// True when no file is named.
bool ReadKey(const char* option, const std::string& file, std::optional<vestibule::Key>& key, std::string& error) {
  if (file.empty()) return true;
  key = vestibule::LoadOrMakeKey(file, error);
  if (!key) error = option + (": " + error);
  return key.has_value();
}

}  // namespace

std::string FindOwnerKeyFile(const GateFiles& files) {
  return files.ownerKey.empty() ? vestibule::FindStateFile(vestibule::kOwnerKeyName).string() : files.ownerKey;
}

std::vector<std::string> FindReadableByAll(const GateFiles& files, std::vector<std::string> others) {
  std::vector<std::string> found;
  others.insert(others.end(), {files.password, files.tokenKey, FindOwnerKeyFile(files), files.gatewayKey});
  for (const std::string& file : others) {
    std::error_code ignored;
    const auto permissions = std::filesystem::status(file, ignored).permissions();
    const bool isThere = !file.empty() && !ignored && permissions != std::filesystem::perms::unknown;
    if (isThere && (permissions & std::filesystem::perms::others_read) != std::filesystem::perms::none) {
      found.push_back(file);
    }
  }
  return found;
}

std::vector<std::string> FindMistakes(const GateFiles& files) {
  std::vector<std::string> mistakes;
  std::string error;
  if (!files.password.empty() && !vestibule::ReadSecret(files.password, error)) {
    mistakes.push_back("--password-file: " + error);
  }
  for (const auto& [option, file] : {std::pair("--token-key", files.tokenKey), std::pair("--owner-key", files.ownerKey),
                                     std::pair("--gateway-key", files.gatewayKey)}) {
    std::error_code ignored;
    if (file.empty() || !std::filesystem::exists(file, ignored) || vestibule::LoadKey(file, error)) continue;
    mistakes.push_back(option + (": " + error));
  }
  if (Bans bans; !bans.Read(files.bans, error)) mistakes.push_back("--bans: " + error);
  if (Invites invites; !invites.Read(files.invites, error)) mistakes.push_back("--invites: " + error);
  return mistakes;
}

namespace {

// nullopt with one line in `error` that names the option.
std::optional<GateSettings> ReadSettings(const GateFiles& files, const vestibule::Key& secretKey,
                                         std::function<std::uint64_t()> readUnixTime, std::string& error) {
  GateSettings settings;
  settings.secretKey = secretKey;
  settings.readUnixTime = std::move(readUnixTime);
  settings.isByInviteOnly = !files.invites.empty();
  settings.givesTicketsToAll = files.givesTicketsToAll;
  if (!files.password.empty()) {
    const auto password = vestibule::ReadSecret(files.password, error);
    if (!password) {
      error = "--password-file: " + error;
      return {};
    }
    settings.password = *password;
  }
  if (!ReadKey("--token-key", files.tokenKey, settings.token, error)) return {};
  if (!ReadKey("--gateway-key", files.gatewayKey, settings.gateway, error)) return {};
  // Without a folder for it a server has no owner, which is no reason not to start.
  std::string ignored;
  const bool hasOwner = ReadKey("--owner-key", FindOwnerKeyFile(files), settings.owner, ignored);
  if (!hasOwner && !files.ownerKey.empty()) {
    error = ignored;
    return {};
  }
  return settings;
}

}  // namespace

std::shared_ptr<Gate> OpenGate(const GateFiles& files, const vestibule::Key& secretKey,
                               std::function<std::uint64_t()> readUnixTime, std::string& error) {
  auto settings = ReadSettings(files, secretKey, std::move(readUnixTime), error);
  if (!settings) return nullptr;
  Bans bans;
  if (!bans.Load(files.bans, error)) {
    error = "--bans: " + error;
    return nullptr;
  }
  Invites invites;
  if (!invites.Load(files.invites, error)) {
    error = "--invites: " + error;
    return nullptr;
  }
  return std::make_shared<Gate>(*std::move(settings), std::move(bans), std::move(invites));
}

bool ReloadGate(const GateFiles& files, Gate& gate, std::string& error) {
  auto settings = ReadSettings(files, {}, nullptr, error);
  return settings && gate.Reload(*std::move(settings), error);
}

}  // namespace wobble::admission
