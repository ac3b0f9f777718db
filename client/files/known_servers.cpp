#include "client/files/known_servers.h"

#include <cstdlib>
#include <fstream>
#include <system_error>

namespace wobble::files {
namespace {

// localhost, 127.x.x.x and [::1].
bool IsThisMachine(const std::string& address) {
  return address.starts_with("localhost:") || address.starts_with("127.") || address.starts_with("[::1]:") ||
         address.starts_with("::1:");
}

}  // namespace

std::optional<transport::vestibule::Key> KnownServers::Find(const std::string& address) const {
  std::ifstream in(m_file);
  std::string name, key;
  while (in >> name >> key) {
    // A damaged key is one that no server has: better refused than trusted anew.
    if (name == address) return transport::vestibule::ParseKey(key).value_or(transport::vestibule::Key{});
  }
  return {};
}

void KnownServers::Note(const std::string& address, const transport::vestibule::Key& key) const {
  if (m_file.empty() || IsThisMachine(address) || Find(address)) return;
  std::error_code ignored;
  std::filesystem::create_directories(m_file.parent_path(), ignored);
  std::ofstream(m_file, std::ios::app) << address << ' ' << transport::vestibule::FormatKey(key) << '\n';
}

std::filesystem::path FindKnownServersFile() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data == '/') {
    return std::filesystem::path(data) / "wobble" / "known_servers";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return std::filesystem::path(home) / ".local" / "share" / "wobble" / "known_servers";
  }
  return {};
}

}  // namespace wobble::files
