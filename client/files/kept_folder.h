// A folder that keeps downloaded blueprints from one connection to the next.
//
// A blueprint's hash is no defence against forgery, so the blueprints of each server are kept apart: a hostile server
// can spoil only its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "client/client.h"

namespace wobble::files {

// Lets a client begin with what the folder has of this server, and adds what it downloads. folder, server: as below.
void UseKeptFolder(const std::filesystem::path& folder, const std::string& server, client::Options& options);

class KeptFolder {
 public:
  // folder: of all servers; empty: nothing is kept. server: names the one that is connected to, such as "HOST:PORT".
  KeptFolder(const std::filesystem::path& folder, const std::string& server);

  // The blueprints of this server, the newest first, within protocol::kMaxKeptBlueprints and kMaxKeptBytes. Files that
  // cannot be read, or whose bytes have another hash than their name says, are left out.
  [[nodiscard]] std::shared_ptr<const client::KeptBlueprints> Load() const;
  // Writes one, and removes the oldest ones of this server beyond what Load reads, and of all servers beyond 64 MiB. A
  // folder that cannot be written is no error.
  void Keep(std::uint64_t hash, std::span<const std::uint8_t> bytes) const;

 private:
  std::filesystem::path m_all;
  std::filesystem::path m_own;  // empty: nothing is kept
};

// $XDG_CACHE_HOME/wobble/bases, or ~/.cache/wobble/bases; empty when neither is known.
[[nodiscard]] std::filesystem::path FindBasesFolder();

}  // namespace wobble::files
