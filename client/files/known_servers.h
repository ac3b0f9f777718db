// The keys of servers that this user has been to, one line each: HOST:PORT and the key.
//
// The first visit takes a server's key as it comes; from then on an address must answer with the same key. That keeps
// out whoever gets between later, like ssh's known_hosts. Servers on this machine are not noted: nobody is between.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "protocol/transport/vestibule/keys.h"

namespace wobble::files {

class KnownServers {
 public:
  // file: empty: nothing is known, and nothing noted.
  explicit KnownServers(std::filesystem::path file) : m_file(std::move(file)) {}

  // address: HOST:PORT as the user wrote it. A key that is damaged in the file is one that no server has: zeros.
  [[nodiscard]] std::optional<transport::vestibule::Key> Find(const std::string& address) const;
  // Notes the key of an address that is not known. A file that cannot be written is no error.
  void Note(const std::string& address, const transport::vestibule::Key& key) const;

  [[nodiscard]] const std::filesystem::path& File() const { return m_file; }

 private:
  std::filesystem::path m_file;
};

// $XDG_DATA_HOME/wobble/known_servers, or ~/.local/share/wobble/known_servers; empty when neither is known.
[[nodiscard]] std::filesystem::path FindKnownServersFile();

}  // namespace wobble::files
